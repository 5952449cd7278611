// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs the sketch on the host: sensors that stand still at a code of the ADC, a closed enable chain, a clock that goes
// on by 20 us with each look. Arguments: the code, bytes from the host (hex), and for how long in us. Prints, in hex,
// what the board sends.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "satvib_device.ino"

static uint32_t now_us = 0;
static int code = 0;
static std::string from_host;

uint32_t micros() { return now_us += 20; }
void delayMicroseconds(uint32_t time) { now_us += time; }
int analogRead(uint8_t) { return code; }
void analogReadResolution(unsigned) {}
void pinMode(uint8_t, uint8_t) {}
void digitalWrite(uint8_t, uint8_t) {}
int digitalRead(uint8_t) { return LOW; }
volatile uint32_t WDOG3_CNT, WDOG3_CS = WDOG_CS_ULK, WDOG3_WIN, WDOG3_TOVAL, CCM_CCGR5;
void __disable_irq() {}
void __enable_irq() {}

SerialPort Serial;
void SerialPort::begin(uint32_t) {}
int SerialPort::available() { return static_cast<int>(from_host.size()); }
int SerialPort::availableForWrite() { return 1000; }
size_t SerialPort::readBytes(uint8_t *data, size_t size) {
  std::memcpy(data, from_host.data(), size);
  from_host.erase(0, size);
  return size;
}
size_t SerialPort::write(const uint8_t *data, size_t size) {
  for (size_t i = 0; i < size; ++i) std::printf("%02x", data[i]);
  return size;
}

SPISettings::SPISettings(uint32_t, uint8_t, uint8_t) {}
SpiBus SPI;
void SpiBus::begin() {}
void SpiBus::beginTransaction(const SPISettings &) {}
void SpiBus::endTransaction() {}
uint8_t SpiBus::transfer(uint8_t) { return 0; }

int main(int, char **arguments) {
  code = std::atoi(arguments[1]);
  const std::string hex = arguments[2];
  for (size_t i = 0; i + 1 < hex.size(); i += 2)
    from_host += static_cast<char>(std::strtoul(hex.substr(i, 2).c_str(), nullptr, 16));
  const uint32_t end = static_cast<uint32_t>(std::atoi(arguments[3]));
  setup();
  while (now_us < end) loop();
}
