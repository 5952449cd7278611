# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compile and link the reference firmware for a Teensy 4.1, without the Arduino program.

It needs the compiler (Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi, libstdc++-arm-none-eabi-newlib), the folder
`teensy4` of the Teensy's core (PaulStoffregen/cores) and its SPI library (PaulStoffregen/SPI), both from GitHub:

    python tools/compile_firmware.py --core cores/teensy4 --spi SPI

It prints the size of the program. It does not load it into a board.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

SKETCH = Path(__file__).parents[1] / 'src' / 'satvib_daq_bridge' / 'firmware' / 'satvib_device'
# as boards.txt of the Teensy says
MACHINE = ['-mthumb', '-mcpu=cortex-m7', '-mfloat-abi=hard', '-mfpu=fpv5-d16']
DEFINES = [
    '-D__IMXRT1062__', '-DTEENSYDUINO=159', '-DARDUINO=10607', '-DARDUINO_TEENSY41', '-DF_CPU=600000000',
    '-DUSB_SERIAL', '-DLAYOUT_US_ENGLISH',
]  # fmt: skip
COMMON = ['-O2', '-g0', '-ffunction-sections', '-fdata-sections', '-nostdlib', '-w']
CPP = ['-std=gnu++17', '-fno-exceptions', '-fno-rtti', '-felide-constructors', '-fpermissive']
STRICT = ['-Wall', '-Wextra', '-Werror=return-type']


def main() -> int:
    """Check the folders and build; gives the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--core', type=Path, required=True, help='folder teensy4 of the core')
    parser.add_argument('--spi', type=Path, required=True, help='folder of the SPI library')
    parser.add_argument('--prefix', default='arm-none-eabi-', help='of the compiler')
    options = parser.parse_args()
    for path in (options.core / 'Arduino.h', options.spi / 'SPI.h'):
        if not path.is_file():
            print(f'compile_firmware: {path} is missing', file=sys.stderr)
            return 2
    with tempfile.TemporaryDirectory() as folder:
        return build(options.core, options.spi, options.prefix, Path(folder))


def build(core: Path, spi: Path, prefix: str, out: Path) -> int:
    """Compile the core, the library and the sketch, and link them; gives the exit code."""
    sources = sorted(p for p in core.iterdir() if p.suffix in {'.c', '.cpp', '.S'})
    sketch = out / 'satvib_device.cpp'
    sketch.write_text((SKETCH / 'satvib_device.ino').read_text(encoding='utf-8'), encoding='utf-8')
    includes = [f'-I{core}', f'-I{spi}', f'-I{SKETCH}']
    objects = []
    for number, source in enumerate([*sources, spi / 'SPI.cpp', sketch]):
        objects.append(out / f'{number}.o')
        cpp = source.suffix == '.cpp'
        command = [prefix + ('g++' if cpp else 'gcc'), *MACHINE, *DEFINES, *COMMON, *includes]
        command += CPP if cpp else []
        command += STRICT if source == sketch else []
        done = subprocess.run([*command, '-c', '-o', objects[-1], source], check=False)
        if done.returncode:
            print(f'compile_firmware: {source.name} does not compile', file=sys.stderr)
            return 1
    elf = out / 'satvib_device.elf'
    link = [
        prefix + 'gcc',
        *MACHINE,
        '-O2',
        '-Wl,--gc-sections',
        '-Wl,--relax',
        f'-T{core / "imxrt1062_t41.ld"}',
    ]
    done = subprocess.run([*link, '-o', elf, *objects, '-lm', '-lstdc++'], check=False)
    if done.returncode == 0:
        subprocess.run([prefix + 'size', elf], check=True)
    return 1 if done.returncode else 0


if __name__ == '__main__':
    sys.exit(main())
