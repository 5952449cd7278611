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
int analogRead(uint8_t pin);
void analogReadResolution(unsigned bits);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
struct SerialPort {
  void begin(uint32_t baud);
  int available();
  int availableForWrite();
  size_t readBytes(uint8_t *data, size_t size);
  size_t write(const uint8_t *data, size_t size);
};
extern SerialPort Serial;
