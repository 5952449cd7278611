// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

constexpr uint8_t MSBFIRST = 1, SPI_MODE1 = 4;
struct SPISettings {
  SPISettings(uint32_t clock, uint8_t order, uint8_t mode);
};
struct SpiBus {
  void begin();
  void beginTransaction(const SPISettings &settings);
  void endTransaction();
  uint8_t transfer(uint8_t data);
};
extern SpiBus SPI;
