// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
//
// As much of an Arduino as the sketch uses, so that a compiler can check it without a board.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

constexpr uint8_t A0 = 14, A1 = 15, A2 = 16, A3 = 17, A4 = 18, A5 = 19;
constexpr uint8_t INPUT_PULLUP = 2, OUTPUT = 1, HIGH = 1, LOW = 0;
constexpr double PI = 3.14159265358979323846;
uint32_t micros();
void delayMicroseconds(uint32_t time);
int analogRead(uint8_t pin);
void analogReadResolution(unsigned bits);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int digitalRead(uint8_t pin);

// the watchdog of the i.MX RT1062, as the Teensy's core names it
extern volatile uint32_t WDOG3_CNT, WDOG3_CS, WDOG3_WIN, WDOG3_TOVAL, CCM_CCGR5;
constexpr uint32_t WDOG_CS_EN = 1u << 7, WDOG_CS_ULK = 1u << 11, WDOG_CS_CMD32EN = 1u << 13, CCM_CCGR_ON = 3;
constexpr uint32_t WDOG_CS_CLK(uint32_t n) { return n << 8; }
constexpr uint32_t CCM_CCGR5_WDOG3(uint32_t n) { return n << 20; }
void __disable_irq();
void __enable_irq();

struct SerialPort {
  void begin(uint32_t baud);
  int available();
  int availableForWrite();
  size_t readBytes(uint8_t *data, size_t size);
  size_t write(const uint8_t *data, size_t size);
};
extern SerialPort Serial;
