# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Write into every package.xml of a Python package what the package imports.

    tools/package_xml.py            writes them
    tools/package_xml.py --check    says what differs; exit code 1 when something does

Imports inside functions count: a command that imports late needs its library all the same. What has a key in rosdep is
a dependency; what has none stands under <export> as `pip_depend`, since rosdep refuses a whole workspace for one key
that it does not know; what only an optional back end or format needs is `pip_optional` there.
"""

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# import name -> key of rosdep
KEYS = {
    'grpc': 'python3-grpcio',
    'hypothesis': 'python3-hypothesis',
    'jinja2': 'python3-jinja2',
    'llvmlite': 'python3-numba',
    'matplotlib': 'python3-matplotlib',
    'numba': 'python3-numba',
    'numpy': 'python3-numpy',
    'psutil': 'python3-psutil',
    'pytest': 'python3-pytest',
    'rich': 'python3-rich',
    'rosbags': 'python3-rosbags-pip',
    'ruamel': 'python3-ruamel.yaml',
    'scipy': 'python3-scipy',
    'serial': 'python3-serial',
    'tornado': 'python3-tornado',
    'typer': 'python3-typer',
    'yaml': 'python3-yaml',
}
# import name -> distribution on the package index
PIP = {
    'cobs': 'cobs',
    'dask': 'dask',
    'distributed': 'distributed',
    'lz4': 'lz4',
    'mcap': 'mcap',
    'mcap_ros2': 'mcap-ros2-support',
    'padasip': 'padasip',
    'pyarrow': 'pyarrow',
    'zstandard': 'zstandard',
}
OPTIONAL = {
    'grpc': 'nidaqmx[grpc]',
    'h5py': 'h5py',
    'iio': 'pylibiio<1',
    'nidaqmx': 'nidaqmx[grpc]',
    'nptdms': 'nptdms',
    'pyuff': 'pyuff',
}
# of ROS 2 itself: the key is the name
ROS = re.compile(
    r'(rclpy|launch|launch_ros|ament_index_python|rosidl_runtime_py|\w+_msgs|\w+_interfaces|std_srvs)'
)
DEPENDS = re.compile(r'(?<=</license>\n).*?(?=\n  <export>)', re.DOTALL)
PIPS = re.compile(r'    <pip_\w+>.*</pip_\w+>\n')


class UnknownImportError(Exception):
    """An import that stands in none of the tables above."""


def imported(folder: Path, own: str) -> set[str]:
    """Name what the modules of a folder import, without the standard library and the package itself."""
    found = set()
    for path in folder.rglob('*.py'):
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                found |= {alias.name.split('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.split('.')[0])
    # modules beside a test, and of benchmarks/; a back end may have the name of the library that it uses
    beside = {p.stem for place in (folder, ROOT / 'benchmarks') for p in place.rglob('*.py')}
    found -= beside - KEYS.keys() - PIP.keys() - OPTIONAL.keys()
    return {name for name in found if name not in sys.stdlib_module_names and name != own}


def key_of(name: str, where: str) -> str | None:
    """Give the key of rosdep for an import; none when there is none.

    Raises:
        UnknownImportError: nothing is known about the import.
    """
    if name.startswith('satvib_') or ROS.fullmatch(name):
        return name
    if name in OPTIONAL or name in PIP:
        return None
    if name not in KEYS:
        raise UnknownImportError(f'{where} imports {name}: name it in tools/package_xml.py')
    return KEYS[name]


def expected(package: Path) -> str:
    """Write the package.xml that a package should have.

    Raises:
        UnknownImportError: nothing is known about an import.
    """
    name = package.name
    source = imported(package / name, name) | imported(package / 'launch', name)
    tests = imported(package / 'test', name)
    needed = {key for i in source if (key := key_of(i, name))}
    # a test may use a package above its own: colcon would see a circle
    tested = {key for i in tests if (key := key_of(i, name)) and not key.startswith('satvib_')}
    tested |= {'python3-pytest'}
    lines = ['']
    lines += [f'  <exec_depend>{key}</exec_depend>' for key in sorted(needed)]
    lines += ['', *[f'  <test_depend>{key}</test_depend>' for key in sorted(tested - needed)], '']
    pips = [f'    <pip_depend>{PIP[i]}</pip_depend>\n' for i in sorted(source & PIP.keys())]
    optional = {OPTIONAL[i].replace('<', '&lt;') for i in source & OPTIONAL.keys()}
    pips += [f'    <pip_optional>{text}</pip_optional>\n' for text in sorted(optional)]
    text = PIPS.sub('', (package / 'package.xml').read_text(encoding='utf-8'))
    text = DEPENDS.sub('\n'.join(lines), text, count=1)
    return text.replace('  <export>\n', '  <export>\n' + ''.join(pips), 1)


def packages() -> list[Path]:
    """Name the Python packages of the workspace."""
    return sorted(path.parent for path in (ROOT / 'src').glob('*/setup.py'))


def main() -> int:
    """Write or check.

    Returns:
        an exit code.
    """
    wrong = 0
    for package in packages():
        path = package / 'package.xml'
        try:
            text = expected(package)
        except UnknownImportError as error:
            print(error)
            return 2
        if path.read_text(encoding='utf-8') != text:
            wrong += 1
            print(f'{path.relative_to(ROOT)} differs from what the package imports')
            if '--check' not in sys.argv:
                path.write_text(text, encoding='utf-8')
    return 1 if wrong and '--check' in sys.argv else 0


if __name__ == '__main__':
    sys.exit(main())
