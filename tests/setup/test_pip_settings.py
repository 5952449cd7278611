# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What people have set for pip holds for uv. Truth: pip's own `config list`, and pip's documentation."""

import os
import subprocess
import sys

import pytest
from workspace.pip_settings import effective, for_uv, uv_cache


def listed(environment, config=None, tmp_path=None):
    """What pip says that holds, with nothing but a configuration file and an environment."""
    env = {k: v for k, v in os.environ.items() if not k.startswith('PIP_')} | environment
    file = os.devnull
    if config is not None:
        file = tmp_path / 'pip.conf'
        file.write_text(config)
    done = subprocess.run(
        [sys.executable, '-m', 'pip', 'config', 'list'],
        env=env | {'PIP_CONFIG_FILE': str(file)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_environment_variables_of_pip_reach_uv():
    text = listed(
        {
            'PIP_INDEX_URL': 'https://index.example/simple',
            'PIP_EXTRA_INDEX_URL': 'https://a.example/simple https://b.example/simple',
            'PIP_CERT': '/etc/some ca.pem',
            'PIP_TRUSTED_HOST': 'index.example',
            'PIP_DEFAULT_TIMEOUT': '90',
            'PIP_PROXY': 'http://proxy.example:3128',
        }
    )
    found = for_uv(effective(text), {})
    assert found['UV_DEFAULT_INDEX'] == 'https://index.example/simple'
    assert found['UV_INDEX'] == 'https://a.example/simple https://b.example/simple'
    assert found['SSL_CERT_FILE'] == '/etc/some ca.pem'
    assert found['UV_INSECURE_HOST'] == 'index.example'
    assert found['UV_HTTP_TIMEOUT'] == '90'
    assert found['HTTPS_PROXY'] == found['https_proxy'] == 'http://proxy.example:3128'


def test_a_configuration_file_of_pip_reaches_uv_and_the_environment_wins(tmp_path):
    config = """
[global]
index-url = https://file.example/simple
timeout = 20
[install]
timeout = 30
[download]
timeout = 40
"""
    text = listed({'PIP_INDEX_URL': 'https://env.example/simple'}, config, tmp_path)
    found = for_uv(effective(text), {})
    assert found['UV_DEFAULT_INDEX'] == 'https://env.example/simple'
    assert found['UV_HTTP_TIMEOUT'] == '30'


def test_what_is_set_for_uv_itself_stays():
    settings = {'index-url': 'https://pip.example/simple', 'extra-index-url': 'https://x.example/'}
    found = for_uv(settings, {'UV_DEFAULT_INDEX': 'https://uv.example/', 'UV_EXTRA_INDEX_URL': 'y'})
    assert 'UV_DEFAULT_INDEX' not in found
    assert 'UV_INDEX' not in found


def test_places_that_are_not_there_are_passed_by_as_pip_does(tmp_path):
    there = tmp_path / 'a folder'
    there.mkdir()
    settings = {
        'extra-index-url': f'file://{tmp_path}/none/simple {there.as_uri()}',
        'find-links': f'{tmp_path}/none https://links.example/ {tmp_path}',
    }
    found = for_uv(settings, {})
    assert found['UV_INDEX'] == there.as_uri()
    assert found['UV_FIND_LINKS'] == f'https://links.example/,{tmp_path}'


def test_no_index_leaves_the_indexes_out():
    settings = {'no-index': 'true', 'index-url': 'https://pip.example/simple', 'find-links': '/'}
    assert for_uv(settings, {}) == {'UV_NO_INDEX': '1', 'UV_FIND_LINKS': '/'}


def test_lines_that_are_no_settings_are_passed_by():
    text = "WARNING: something\nglobal.cert='/a'\nlist.format='json'\nglobal.timeout=broken(\n"
    assert effective(text) == {'cert': '/a'}


@pytest.mark.parametrize('home', ['/proc/nobody', '', '/dev/null'])
def test_downloads_are_kept_in_the_workspace_when_home_cannot_be_written(home, tmp_path):
    assert uv_cache({'HOME': home}, tmp_path) == {'UV_CACHE_DIR': str(tmp_path)}


def test_downloads_are_kept_where_uv_keeps_them(tmp_path):
    assert uv_cache({'HOME': str(tmp_path)}, tmp_path / 'x') == {}
    assert uv_cache({'HOME': '/proc', 'UV_CACHE_DIR': '/here'}, tmp_path) == {}
