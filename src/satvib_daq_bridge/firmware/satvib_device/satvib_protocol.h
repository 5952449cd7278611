// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
//
// The device's side of the satvib serial protocol (docs/serial_protocol.md): without heap, hardware or clock.
// A test of satvib_daq_bridge compiles this file and compares it with the Python model, byte for byte.
//
// Times are microseconds of a 32-bit clock that wraps (Arduino's micros()); voltages are whole microvolts.
#ifndef SATVIB_PROTOCOL_H
#define SATVIB_PROTOCOL_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

namespace satvib {

constexpr uint8_t kVersion = 1;
constexpr size_t kLongestPayload = 240;
constexpr size_t kLongestFrame = kLongestPayload + 4;
constexpr size_t kHead = 7;
constexpr uint32_t kLongestPeriod = 1000000000;  // ns
constexpr uint32_t kLongestLifetime = 50000;     // us

enum Kind : uint8_t {
  kHello = 0x01, kConfigure = 0x02, kCommand = 0x03, kZero = 0x04, kStop = 0x05,
  kIdentity = 0x81, kConfigured = 0x82, kSample = 0x83,
};
enum Hold : uint8_t { kHoldZero = 0, kHoldLinear = 1 };
enum Refusal : uint8_t { kNone = 0, kPeriod = 1, kLifetime = 2, kCounts = 3, kLimits = 4 };
enum Flag : uint8_t { kEnabled = 1, kExpired = 2, kZeroed = 4, kOverrun = 8, kOpened = 16 };

// CRC-16/CCITT, polynomial 0x1021, initial value 0xFFFF.
inline uint16_t crc16(const uint8_t *data, size_t size) {
  uint16_t crc = 0xFFFF;
  for (size_t i = 0; i < size; ++i) {
    crc ^= static_cast<uint16_t>(data[i]) << 8;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x8000) ? static_cast<uint16_t>((crc << 1) ^ 0x1021) : static_cast<uint16_t>(crc << 1);
  }
  return crc;
}

// Stuffs `size` bytes (at most kLongestPayload + 2) into `out`; gives the length without the closing zero.
inline size_t cobsEncode(const uint8_t *data, size_t size, uint8_t *out) {
  size_t code_at = 0, at = 1;
  uint8_t code = 1;
  for (size_t i = 0; i < size; ++i) {
    if (data[i] != 0) {
      out[at++] = data[i];
      ++code;
    }
    if (data[i] == 0 || code == 0xFF) {
      out[code_at] = code;
      if (data[i] != 0 && i + 1 == size) return at;  // a full block that ends the data
      code_at = at++;
      code = 1;
    }
  }
  out[code_at] = code;
  return at;
}

// Undoes cobsEncode in place; gives the length, or -1 for bytes that are no valid encoding.
inline int cobsDecode(uint8_t *data, size_t size) {
  size_t at = 0, out = 0;
  while (at < size) {
    const uint8_t code = data[at];
    if (code == 0 || at + code > size) return -1;
    for (size_t i = 1; i < code; ++i) {
      if (data[at + i] == 0) return -1;
      data[out++] = data[at + i];
    }
    at += code;
    if (code != 0xFF && at < size) data[out++] = 0;
  }
  return static_cast<int>(out);
}

inline uint16_t get16(const uint8_t *p) { return static_cast<uint16_t>(p[0] | (p[1] << 8)); }
inline uint32_t get32(const uint8_t *p) { return get16(p) | (static_cast<uint32_t>(get16(p + 2)) << 16); }
inline uint8_t *put8(uint8_t *p, uint8_t v) { *p = v; return p + 1; }
inline uint8_t *put16(uint8_t *p, uint16_t v) { return put8(put8(p, v & 0xFF), v >> 8); }
inline uint8_t *put32(uint8_t *p, uint32_t v) { return put16(put16(p, v & 0xFFFF), v >> 16); }

struct Identity {
  uint8_t bits;
  int32_t input_low, input_high, output_low, output_high;  // uV
  uint32_t shortest_period;                                // ns
  char name[17];
};

// Where the answers go; `data` is one whole frame with its closing zero. False: no room, the frame is dropped.
typedef bool (*Writer)(const uint8_t *data, size_t size);

template <uint8_t Inputs, uint8_t Outputs>
class Device {
 public:
  Device(const Identity &identity, Writer writer) : identity_(identity), writer_(writer) {}

  // Takes bytes from the host.
  void receive(const uint8_t *data, size_t size, uint32_t now) {
    for (size_t i = 0; i < size; ++i) {
      if (data[i] == 0) {
        close(now);
      } else if (length_ < kLongestFrame) {
        piece_[length_++] = data[i];
      } else {
        too_long_ = true;
      }
    }
  }

  // Sends a sample (uV).
  void takeSample(const int32_t *inputs, uint32_t now) {
    if (!configured_) return;
    watch(now);
    uint8_t payload[kLongestPayload];
    uint8_t *p = head(payload, kSample, session_, samples_);
    p = put32(p, now);
    p = put8(p, latch_ | (enabled_ ? kEnabled : 0) | (overrun_ ? kOverrun : 0));
    p = put32(p, command_);
    p = put16(p, rejected_);
    p = put16(p, refused_);
    p = put16(p, dropped_);
    p = put8(p, inputs_);
    for (uint8_t i = 0; i < inputs_; ++i) p = put32(p, static_cast<uint32_t>(inputs[i]));
    if (!send(payload, p)) ++dropped_;
    ++samples_;
    overrun_ = false;
  }

  void overrun() { overrun_ = true; }

  // Puts the outputs to 0 V when no command has come for too long; call it in every turn of the loop.
  void watch(uint32_t now) {
    if (enabled_ && now - heard_ >= lifetime_) zero(kExpired);
  }

  // Reports the contact of the enable chain; an open chain puts the outputs to 0 V and latches. Call it in every turn.
  void chain(bool closed) {
    closed_ = closed;
    if (!closed) zero(kOpened);
  }

  // Voltage at an output now (uV).
  int32_t output(uint8_t i, uint32_t now) const {
    const uint64_t moved = static_cast<uint64_t>(now - arrived_) * 1000;
    if (hold_ == kHoldZero || moving_ == false || moved >= period_) return target_[i];
    // the whole sum in 64 bits: from one end of the range to the other is more than 32 bits hold
    const int64_t way = static_cast<int64_t>(target_[i]) - start_[i];
    return static_cast<int32_t>(start_[i] + way * static_cast<int64_t>(moved) / static_cast<int64_t>(period_));
  }

  bool configured() const { return configured_; }
  bool enabled() const { return enabled_; }
  uint32_t period() const { return period_; }  // ns
  uint32_t begun() const { return begun_; }    // us; sample 0 is due one period later

 private:
  static uint8_t *head(uint8_t *p, uint8_t kind, uint16_t session, uint32_t number) {
    return put32(put16(put8(p, kind), session), number);
  }

  bool send(uint8_t *payload, uint8_t *end) {
    const uint16_t crc = crc16(payload, static_cast<size_t>(end - payload));
    end = put16(end, crc);
    uint8_t wire[kLongestFrame + 1];
    const size_t size = cobsEncode(payload, static_cast<size_t>(end - payload), wire);
    wire[size] = 0;
    return writer_(wire, size + 1);
  }

  void close(uint32_t now) {
    const size_t size = length_;
    const bool too_long = too_long_;
    length_ = 0;
    too_long_ = false;
    if (size == 0 && !too_long) return;
    const int whole = too_long ? -1 : cobsDecode(piece_, size);
    if (whole <= 2 || crc16(piece_, static_cast<size_t>(whole) - 2) != get16(piece_ + whole - 2)) {
      ++rejected_;
      return;
    }
    take(piece_, static_cast<size_t>(whole) - 2, now);
  }

  void take(const uint8_t *payload, size_t size, uint32_t now) {
    if (size < kHead) return;
    const uint8_t kind = payload[0];
    const uint16_t session = get16(payload + 1);
    const uint32_t number = get32(payload + 3);
    const uint8_t *body = payload + kHead;
    size -= kHead;
    switch (kind) {
      case kHello: if (size == 0) sayIdentity(session, number); break;
      case kConfigure: configure(session, number, body, size, now); break;
      case kCommand: command(session, number, body, size, now); break;
      case kZero: if (size == 0) zero(kZeroed); break;
      case kStop: if (size == 0) { zero(kZeroed); configured_ = false; } break;
      default: break;
    }
  }

  void sayIdentity(uint16_t session, uint32_t number) {
    uint8_t payload[kLongestPayload];
    uint8_t *p = head(payload, kIdentity, session, number);
    p = put8(put8(put8(put8(p, kVersion), Inputs), Outputs), identity_.bits);
    p = put32(put32(p, static_cast<uint32_t>(identity_.input_low)), static_cast<uint32_t>(identity_.input_high));
    p = put32(put32(p, static_cast<uint32_t>(identity_.output_low)), static_cast<uint32_t>(identity_.output_high));
    p = put32(p, identity_.shortest_period);
    memcpy(p, identity_.name, 16);
    send(payload, p + 16);
  }

  void configure(uint16_t session, uint32_t number, const uint8_t *body, size_t size, uint32_t now) {
    if (size < 11 || size != 11 + 4u * body[10] || body[8] > kHoldLinear) return;
    const uint32_t period = get32(body), lifetime = get32(body + 4);
    uint8_t refusal = kNone;
    if (period < identity_.shortest_period || period > kLongestPeriod) refusal = kPeriod;
    else if (lifetime == 0 || lifetime > kLongestLifetime) refusal = kLifetime;
    else if (body[9] > Inputs || body[10] != Outputs) refusal = kCounts;
    else
      for (uint8_t i = 0; i < Outputs; ++i)
        if (static_cast<int32_t>(get32(body + 11 + 4 * i)) < 0) refusal = kLimits;
    if (refusal == kNone) {
      zero(0);
      latch_ = closed_ ? 0 : kOpened;
      configured_ = true;
      session_ = session;
      period_ = period;
      lifetime_ = lifetime;
      hold_ = body[8];
      inputs_ = body[9];
      for (uint8_t i = 0; i < Outputs; ++i) limit_[i] = static_cast<int32_t>(get32(body + 11 + 4 * i));
      begun_ = now;
      samples_ = command_ = 0;
      refused_ = dropped_ = 0;
    }
    uint8_t payload[kHead + 3];
    send(payload, put8(head(payload, kConfigured, session, number), refusal));
  }

  void command(uint16_t session, uint32_t number, const uint8_t *body, size_t size, uint32_t now) {
    if (size < 6 || size != 6 + 4u * body[5] || body[4] > 1) return;
    if (!configured_ || session != session_) {
      ++refused_;
      return;
    }
    watch(now);
    const uint32_t ahead = number - command_;
    const bool in_order = ahead != 0 && ahead < 0x80000000u;
    if (body[4] == 0) {  // a command to 0 V is always taken; only the release of a latch must be in order
      if (enabled_) zero(0);
      if (in_order) {
        command_ = number;
        latch_ = closed_ ? 0 : kOpened;
      }
      return;
    }
    const uint32_t age = samples_ - 1 - get32(body);
    const bool fresh = static_cast<uint64_t>(age) * period_ <= static_cast<uint64_t>(lifetime_) * 1000;
    if (!in_order || !fresh || body[5] != Outputs || latch_ != 0) {
      ++refused_;
      return;
    }
    command_ = number;
    for (uint8_t i = 0; i < Outputs; ++i) start_[i] = output(i, now);
    for (uint8_t i = 0; i < Outputs; ++i) {
      const int32_t value = static_cast<int32_t>(get32(body + 6 + 4 * i));
      target_[i] = value > limit_[i] ? limit_[i] : value < -limit_[i] ? -limit_[i] : value;
    }
    arrived_ = heard_ = now;
    enabled_ = moving_ = true;
  }

  void zero(uint8_t latch) {
    enabled_ = moving_ = false;
    latch_ |= latch;
    for (uint8_t i = 0; i < Outputs; ++i) start_[i] = target_[i] = 0;
  }

  const Identity identity_;
  const Writer writer_;
  uint8_t piece_[kLongestFrame];
  size_t length_ = 0;
  bool too_long_ = false;
  bool configured_ = false, enabled_ = false, overrun_ = false, moving_ = false, closed_ = true;
  uint8_t latch_ = 0, hold_ = kHoldZero, inputs_ = 0;
  uint16_t session_ = 0, rejected_ = 0, refused_ = 0, dropped_ = 0;
  uint32_t period_ = 0, lifetime_ = 0, begun_ = 0, samples_ = 0, command_ = 0, heard_ = 0, arrived_ = 0;
  int32_t limit_[Outputs] = {}, start_[Outputs] = {}, target_[Outputs] = {};
};

}  // namespace satvib

#endif  // SATVIB_PROTOCOL_H
