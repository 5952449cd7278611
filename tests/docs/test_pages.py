# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the pages say leads somewhere. Truth of all tests: the tree of files, and the docstrings in it."""

import ast
import re

import pytest
import write_architecture
from source_tree import PACKAGES, ROOT, modules

PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding='utf-8')
    for path in [*sorted(ROOT.glob('*.md')), *sorted((ROOT / 'docs').rglob('*.md'))]
}
# pictures in the place of the field's words; `dead zone` is the field's word
METAPHORS = re.compile(
    r'\b(anew|bells?|believ\w+|blam\w+|company|dead(?![ _]zone)|die[sd]?|doomed|fates?|guilty'
    r'|lessons?|straw|told|whom)\b',
    re.IGNORECASE,
)
CODE = re.compile(r'```.*?```|`[^`\n]*`', re.DOTALL)


@pytest.mark.parametrize('page', PAGES)
def test_every_link_leads_somewhere(page):
    """Links to files, from the page's own folder."""
    found = re.findall(r'\]\(([^)#\s]+)(?:#[^)]*)?\)', PAGES[page])
    folder = (ROOT / page).parent
    assert [f for f in found if '://' not in f and not (folder / f).exists()] == []


@pytest.mark.parametrize('page', PAGES)
def test_every_path_in_a_package_exists(page):
    """`satvib_control/laws/off.py` is a file or a folder of the package or of its sources."""
    own = '|'.join([*PACKAGES, 'satvib_msgs'])
    found = re.findall(rf'(?<![\w/])((?:{own})/[\w./-]*\w)', PAGES[page])
    bases = {f: [ROOT / 'src' / f.split('/')[0], ROOT / 'src'] for f in found}
    assert [f for f, b in bases.items() if not any((base / f).exists() for base in b)
            and not (ROOT / 'src' / f.split('/')[0] / f.split('/', 1)[1]).exists()] == []  # fmt: skip


@pytest.mark.parametrize('page', PAGES)
def test_every_file_and_test_that_is_named_exists(page):
    """`gain_bounds.py` is the end of a path in the tree; `test_x` is a function of a test."""
    paths = [
        p.as_posix()
        for top in ('src', 'tests', 'benchmarks', 'tools')
        for p in (ROOT / top).rglob('*.py')
    ]
    quoted = re.findall(r'`([\w./]+)`', PAGES[page])
    missing = [
        q for q in quoted if q.endswith('.py') and not any(p.endswith(f'/{q}') for p in paths)
    ]
    names = {q for q in quoted if q.startswith('test_') and '.' not in q}
    if names:
        names -= {
            node.name
            for top in ('src', 'tests')
            for p in (ROOT / top).rglob('test_*.py')
            for node in ast.walk(ast.parse(p.read_text()))
            if isinstance(node, ast.FunctionDef)
        }
    assert missing == []
    assert names == set()


def test_every_name_of_a_recipe_stands_in_its_file():
    """Truth: the file: `LAWS` of `satvib_control/laws/registry.py`."""
    text = PAGES['docs/architecture.md']
    found = re.findall(r'`(\w+)` (?:of|in) `((satvib_\w+)/[\w/]+\.py)`', text)
    found += [(name, path, package) for path, package, name in
              re.findall(r'`((satvib_\w+)/[\w/]+\.py)`,? \(?`(\w+)`', text)]  # fmt: skip
    missing = [
        (name, path)
        for name, path, package in found
        if not re.search(rf'\b{name}\b', (ROOT / 'src' / package / path).read_text())
    ]
    assert missing == []
    assert len(found) > 8


@pytest.mark.parametrize('page', PAGES)
def test_a_page_uses_the_words_of_the_field(page):
    """No picture in the place of a term; names of code are left out."""
    text = CODE.sub('', PAGES[page]).split(write_architecture.BEGIN)[0]
    assert sorted({m[0].lower() for m in METAPHORS.finditer(text)}) == []


def test_the_list_of_rooms_is_current():
    """Truth: the docstrings of the doors and the modules, now."""
    found, wanted = write_architecture.current()
    assert found == wanted, 'run python tools/write_architecture.py'


def test_every_package_and_room_is_in_the_architecture():
    """Truth: the folders."""
    text = PAGES['docs/architecture.md']
    rooms = {'/'.join(m.name.split('.')[1:]) for m in modules().values() if m.is_door}
    assert [r for r in sorted(rooms - {''}) if f'`{r}/`' not in text] == []
    assert [p for p in PACKAGES if f'### {p}\n' not in text] == []


def test_every_page_is_in_the_index():
    """Truth: the files of docs/."""
    index = PAGES['docs/README.md']
    own = {p.removeprefix('docs/') for p in PAGES if p.count('/') == 1} - {'README.md'}
    assert [p for p in sorted(own) if f'({p})' not in index and p != 'installed_ros.md'] == []


def test_the_glossary_is_in_alphabetical_order():
    """Truth: sorted()."""
    terms = re.findall(r'^\| ([^|]+) \|', PAGES['docs/glossary.md'], re.MULTILINE)[2:]
    assert terms == sorted(terms, key=str.casefold)
    assert len(terms) > 50


def test_every_command_exists():
    """`./satvib WORD` in a page is a command of the script or of `satvib`."""
    from satvib_bringup.cli.main import app

    known = {entry.name for entry in [*app.registered_commands, *app.registered_groups]}
    known |= set(re.findall(r'^\s+([\w|-]+)\)', (ROOT / 'satvib').read_text(), re.MULTILINE))
    known = {word for entry in known for word in entry.split('|')}
    used = {
        (word, page)
        for page, text in PAGES.items()
        for word in re.findall(r'\./satvib ([a-z][\w-]*)', text)
    }
    assert sorted(pair for pair in used if pair[0] not in known) == []
