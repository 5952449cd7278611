# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every package.xml names what its package imports, no more and no less. Truth: the imports in the source."""

import xml.etree.ElementTree as ET

import package_xml
import pytest
from catkin_pkg.package import parse_package


@pytest.mark.parametrize('package', package_xml.packages(), ids=lambda path: path.name)
def test_package_xml_names_what_the_package_imports(package):
    """`.venv/bin/python tools/package_xml.py` writes it."""
    assert (package / 'package.xml').read_text() == package_xml.expected(package)


@pytest.mark.parametrize('package', package_xml.packages(), ids=lambda path: path.name)
def test_package_xml_is_read_by_ros_as_it_is_meant(package):
    """Truth: catkin_pkg, which colcon and rosdep read it with."""
    read = parse_package(package / 'package.xml')
    named = {d.name for d in read.exec_depends}
    exported = ET.parse(package / 'package.xml').getroot().find('export')
    pips = {e.text for e in exported if e.tag.startswith('pip_')}
    for name in package_xml.imported(package / package.name, package.name):
        known = {package_xml.PIP.get(name), package_xml.OPTIONAL.get(name)} - {None}
        assert known & pips if known else package_xml.key_of(name, package.name) in named, name
    assert [e.tagname for e in read.exports if e.tagname == 'build_type']


def test_an_import_that_is_not_named_is_found(tmp_path):
    package = tmp_path / 'some_package'
    (package / 'some_package').mkdir(parents=True)
    (package / 'some_package' / 'a.py').write_text('def f():\n    import scipy.linalg\n')
    given = (package_xml.packages()[0] / 'package.xml').read_text()
    (package / 'package.xml').write_text(given)
    text = package_xml.expected(package)
    assert '<exec_depend>python3-scipy</exec_depend>' in text
    assert text != given
    (package / 'some_package' / 'b.py').write_text('import unheard_of\n')
    with pytest.raises(package_xml.UnknownImportError, match='imports unheard_of'):
        package_xml.expected(package)
