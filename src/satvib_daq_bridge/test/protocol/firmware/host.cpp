// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs the firmware's protocol on the host: a line in, a line out. r TIME HEX: receive; s TIME: sample; w TIME: watch;
// o TIME: outputs; c TIME HEX: the enable chain, 01 closed.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "satvib_protocol.h"

static std::string sent;

static bool writer(const uint8_t *data, size_t size) {
  char text[3];
  for (size_t i = 0; i < size; ++i) {
    std::snprintf(text, sizeof text, "%02x", data[i]);
    sent += text;
  }
  return true;
}

int main() {
  satvib::Device<6, 3> device(
      satvib::Identity{12, -5000000, 5000000, -10000000, 10000000, 500000, "test"}, writer);
  const int32_t inputs[6] = {1, -2, 3, -4, 5, -6};
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream in(line);
    std::string what, hex;
    uint32_t now = 0;
    in >> what >> now >> hex;
    sent.clear();
    if (what == "r") {
      std::vector<uint8_t> data;
      for (size_t i = 0; i + 1 < hex.size(); i += 2)
        data.push_back(static_cast<uint8_t>(std::strtoul(hex.substr(i, 2).c_str(), nullptr, 16)));
      device.receive(data.data(), data.size(), now);
    } else if (what == "s") {
      device.takeSample(inputs, now);
    } else if (what == "c") {
      device.chain(hex == "01");
    } else if (what == "w") {
      device.watch(now);
    } else {
      std::ostringstream out;
      for (uint8_t i = 0; i < 3; ++i) out << (i ? "," : "") << device.output(i, now);
      sent = out.str();
    }
    std::cout << sent << std::endl;
  }
}
