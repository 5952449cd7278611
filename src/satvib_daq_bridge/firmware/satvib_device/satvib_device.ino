// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
//
// Reference firmware of a satvib acquisition device: six accelerometers in, three coils out, over USB serial.
//
// Written for a Teensy 4.1 (600 MHz, native USB) with an AD5754R (four outputs of +-10 V, 16 bit, SPI) and the board's
// own 12-bit ADC behind a divider. Another board needs other bodies for the functions under "Hardware"; no other part
// uses the hardware. It was compiled for the Teensy's core (tools/compile_firmware.py) and its protocol was compared
// with the Python model, but it was not run on a board: measure yours with the coils disconnected first.
//
// THIS IS NO SAFETY FUNCTION. Wire the amplifiers' supply through an enable chain with a latching button
// (docs/hardware.md). Wire these too, without which the sketch does not hold what it promises:
//  - an auxiliary contact of the chain between kEnablePin and ground, closed when the chain is closed. Open, or with a
//    broken wire, the pin is high: all outputs go to 0 V, which latches, and the host is told.
//  - 10 kOhm from the DAC's CLR to ground. In reset and until setup() the pin floats; the resistor holds 0 V then, also
//    after the watchdog has reset a hung board.

#include <Arduino.h>
#include <SPI.h>

#include "satvib_protocol.h"

namespace {

constexpr uint8_t kInputs = 6, kOutputs = 3;
constexpr uint32_t kFastPeriod = 125;  // us; the sensors are read and the outputs moved at 8 kHz
constexpr double kCornerShare = 0.35;  // anti-alias corner as a share of the sample rate

constexpr uint8_t kInputPins[kInputs] = {A0, A1, A2, A3, A4, A5};
constexpr uint8_t kDacSelect = 10, kDacClear = 9, kEnablePin = 2;
// uV at the sensor's terminal for each count of the ADC: 3.3 V over 4096 counts behind a divider by 2
constexpr double kMicrovoltsPerCount = 2.0 * 3.3e6 / 4096.0;

// ---- Hardware

int32_t readInput(uint8_t i) {
  return static_cast<int32_t>(analogRead(kInputPins[i]) * kMicrovoltsPerCount);
}

// AD5754R: register 0, address i, two's complement (its pin BIN/2sCOMP to ground), +-10 V.
void writeOutput(uint8_t i, int32_t microvolts) {
  int32_t code = static_cast<int32_t>(static_cast<int64_t>(microvolts) * 32768 / 10000000);
  if (code > 32767) code = 32767;
  if (code < -32768) code = -32768;
  SPI.beginTransaction(SPISettings(20000000, MSBFIRST, SPI_MODE1));
  digitalWrite(kDacSelect, LOW);
  SPI.transfer(i);
  SPI.transfer(static_cast<uint8_t>((code >> 8) & 0xFF));
  SPI.transfer(static_cast<uint8_t>(code & 0xFF));
  digitalWrite(kDacSelect, HIGH);
  SPI.endTransaction();
}

void dacCommand(uint8_t address, uint16_t data) {
  SPI.beginTransaction(SPISettings(20000000, MSBFIRST, SPI_MODE1));
  digitalWrite(kDacSelect, LOW);
  SPI.transfer(address);
  SPI.transfer(static_cast<uint8_t>(data >> 8));
  SPI.transfer(static_cast<uint8_t>(data & 0xFF));
  digitalWrite(kDacSelect, HIGH);
  SPI.endTransaction();
}

void beginHardware() {
  pinMode(kEnablePin, INPUT_PULLUP);
  pinMode(kDacSelect, OUTPUT);
  digitalWrite(kDacSelect, HIGH);
  // a low clear line holds 0 V: during reset, and while the enable chain is open
  pinMode(kDacClear, OUTPUT);
  digitalWrite(kDacClear, LOW);
  SPI.begin();
  dacCommand(0x0C, 4);     // range of all outputs: +-10 V
  dacCommand(0x10, 0x1F);  // power up the four outputs (bits 0 to 3) and the internal reference (bit 4)
  delayMicroseconds(20);   // the outputs take 10 us to power up; codes written before are lost
  for (uint8_t i = 0; i < kOutputs; ++i) writeOutput(i, 0);
  analogReadResolution(12);
}

bool chainClosed() { return digitalRead(kEnablePin) == LOW; }

// A low clear line holds the DAC at 0 V whatever its registers say.
void holdAtZero(bool hold) { digitalWrite(kDacClear, hold ? LOW : HIGH); }

// RTWDOG of the i.MX RT1062: a loop that hangs for kWatchdogTicks resets the board, so CLR goes low. Its clock is named
// 32 kHz; boards were measured up to 128 kHz, so the time is 2.5 to 10 ms. A turn of the loop takes less than 0.2 ms.
constexpr uint32_t kWatchdogTicks = 320;

void beginWatchdog() {
  CCM_CCGR5 |= CCM_CCGR5_WDOG3(CCM_CCGR_ON);
  __disable_irq();  // the set-up must follow the unlocking within 128 clocks of the bus
  WDOG3_CNT = 0xD928C520;
  while (!(WDOG3_CS & WDOG_CS_ULK)) {
  }
  WDOG3_WIN = 0;
  WDOG3_TOVAL = kWatchdogTicks;
  WDOG3_CS = WDOG_CS_EN | WDOG_CS_CLK(1) | WDOG_CS_CMD32EN;  // no UPDATE: nothing can switch it off again
  __enable_irq();
}

void feedWatchdog() { WDOG3_CNT = 0xB480A602; }

// ---- Anti-alias filter: fourth-order Butterworth as two sections, run at the fast rate

struct Section {
  double b0, b1, b2, a1, a2, s1 = 0, s2 = 0;
  double step(double x) {
    const double y = b0 * x + s1;
    s1 = b1 * x - a1 * y + s2;
    s2 = b2 * x - a2 * y;
    return y;
  }
  // the state in which it is after a long time at x; its gain at rest is 1
  void settle(double x) {
    s1 = (1.0 - b0) * x;
    s2 = (b2 - a2) * x;
  }
};

Section filters[kInputs][2];

// Tustin with the corner prewarped; Q of the two sections of a fourth-order Butterworth. They begin at the present
// readings: from 0 V the first samples would show a step, and the host would refuse the bias that it learns from them.
void designFilters(double corner) {
  const double q[2] = {0.541196100146197, 1.306562964876377};
  const double k = tan(PI * corner * kFastPeriod * 1e-6);
  for (uint8_t input = 0; input < kInputs; ++input) {
    const double present = readInput(input);
    for (int i = 0; i < 2; ++i) {
      const double norm = 1.0 / (1.0 + k / q[i] + k * k);
      filters[input][i] = Section{k * k * norm, 2.0 * k * k * norm, k * k * norm, 2.0 * (k * k - 1.0) * norm,
                                  (1.0 - k / q[i] + k * k) * norm};
      filters[input][i].settle(present);
    }
  }
}

// ---- Protocol

bool sendFrame(const uint8_t *data, size_t size) {
  if (Serial.availableForWrite() < static_cast<int>(size)) return false;  // a slow reader loses frames and delays nothing
  return Serial.write(data, size) == size;
}

satvib::Device<kInputs, kOutputs> device(
    satvib::Identity{12, 0, 6600000, -10000000, 10000000, 500000, "satvib teensy41"}, sendFrame);

uint32_t next_fast = 0;
uint64_t next_sample = 0;  // ns since the session began
uint64_t session_time = 0;
uint32_t session_last = 0;
bool in_session = false;
uint32_t session_begun = 0;

void beginSession(uint32_t now) {
  in_session = true;
  session_begun = device.begun();
  session_last = now;
  session_time = 0;
  next_sample = device.period();
  designFilters(kCornerShare * 1e9 / device.period());
}

}  // namespace

void setup() {
  beginHardware();
  Serial.begin(2000000);  // native USB: the number is ignored
  designFilters(100.0);
  next_fast = micros();
  beginWatchdog();
}

void loop() {
  uint32_t now = micros();
  feedWatchdog();
  const bool closed = chainClosed();
  device.chain(closed);
  uint8_t data[64];
  const int waiting = Serial.available();
  if (waiting > 0) {
    const size_t size = Serial.readBytes(data, waiting < 64 ? waiting : 64);
    device.receive(data, size, now);
  }
  device.watch(now);
  if (!device.configured()) {
    in_session = false;
  } else if (!in_session || session_begun != device.begun()) {
    beginSession(now);
  }
  if (static_cast<int32_t>(now - next_fast) < 0) return;
  next_fast += kFastPeriod;
  if (static_cast<int32_t>(now - next_fast) > 0) next_fast = now + kFastPeriod;  // after a delay, the next one is a full period away

  int32_t inputs[kInputs];
  for (uint8_t i = 0; i < kInputs; ++i) {
    const double volts = filters[i][1].step(filters[i][0].step(readInput(i)));
    inputs[i] = static_cast<int32_t>(volts);
  }
  for (uint8_t i = 0; i < kOutputs; ++i) writeOutput(i, device.output(i, now));
  holdAtZero(!closed || !device.configured());
  if (in_session) {
    session_time += static_cast<uint64_t>(now - session_last) * 1000;
    session_last = now;
    if (session_time >= next_sample) {
      if (session_time >= next_sample + device.period()) device.overrun();
      next_sample += device.period();
      device.takeSample(inputs, now);
    }
  }
}
