"""`kinform watch --report`: the page on this machine, which follows every save and keeps its view."""

from __future__ import annotations

import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import urllib.request

import pytest
from support.browser import Browser, program
from support.command_line import environment, listening
from support.places import FIXTURES

from kinform_cli.errors import refuse
from kinform_cli.serving import PageServer


def asked(server, path="/", host=None):
    """Status and body of a request."""
    port = int(server.address.rsplit(":", 1)[1].strip("/"))
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{port}"})
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def test_the_page_is_served_and_nothing_else_is():
    with PageServer(0) as server:
        assert asked(server)[0] == 200
        server.show("<p>one")
        assert asked(server) == (200, "<p>one")
        assert asked(server, "/../etc/passwd")[0] == 404
        assert asked(server, host="evil.example")[0] == 403
        assert server.next_version == "2"
    with pytest.raises(OSError, match="refused"):
        asked(server)


def test_a_port_that_is_taken_is_refused_with_a_remedy():
    with PageServer(0) as server:
        port = int(server.address.rsplit(":", 1)[1].strip("/"))
        with pytest.raises(type(refuse("x")), match=str(port)):
            PageServer(port)


def test_who_follows_is_told_of_every_page_and_of_what_cannot_be_read():
    with PageServer(0) as server:
        server.show("<p>one")
        stream = urllib.request.urlopen(server.address + "changes", timeout=10)
        read = lambda: json.loads([stream.readline(), stream.readline()][0].decode().removeprefix("data: "))
        assert read() == {"version": "1", "text": ""}
        server.say("arm.toml:3: bad")
        assert read() == {"version": "1", "text": "arm.toml:3: bad"}
        server.show("<p>two")
        assert read() == {"version": "2", "text": ""}


@pytest.fixture
def watching(tmp_path):
    """`kinform watch --report` on a copy of a fixture: the address of the page, and the manifest."""
    if program() is None:
        pytest.skip("no Chromium: the page is not opened in a browser")
    folder = shutil.copytree(FIXTURES / "pairs" / "revolute_collars", tmp_path / "design")
    manifest = folder / "revolute_collars.toml"
    command = [sys.executable, "-m", "kinform_cli", "watch", manifest, "-o", tmp_path / "a.h5", "--report"]
    process = subprocess.Popen(
        [*map(str, command), "--period", "0.05"], env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True, preexec_fn=listening,
    )  # fmt: skip
    lines = []
    address = None
    for line in process.stderr:
        lines.append(line)
        if "the page: " in line:
            address = line.split("the page: ")[1].split()[0]
        if "watching" in line:
            break
    assert address, lines
    threading.Thread(target=process.stderr.read, daemon=True).start()
    yield address, manifest
    os.kill(process.pid, signal.SIGINT)
    assert process.wait(20) in (0, 1, 2)


@pytest.mark.slow
def test_the_page_loads_itself_again_on_save_and_keeps_its_view(watching):
    address, manifest = watching
    browser = Browser()
    try:
        browser.ask("Page.navigate", url=address)
        browser.until("document.body && document.body.dataset.viewer === 'ready'")
        assert browser.run("document.body.dataset.live") == "1"
        state = "window.kinformViewer.state"
        browser.run(f"{state}.camera.orbit(0.7, 0.2); {state}.camera.zoom(0.6); window.kinformViewer.flip('xray')")
        browser.run("document.getElementById('bodies').open = true")
        eye = f"[{state}.camera.turn, {state}.camera.rise, {state}.camera.distance]"
        kept = browser.run(eye)
        text = manifest.read_text()
        manifest.write_text(text.replace("[assembly]", "[assembly", 1))
        browser.until("document.getElementById('live')?.textContent.includes('could not be read')")
        assert browser.run("document.body.dataset.live") == "1"
        manifest.write_text(text.replace('type = "revolute"', 'type = "prismatic"'))
        browser.until("document.body?.dataset.live === '2' && document.body.dataset.viewer === 'ready'")
        assert browser.run(eye) == pytest.approx(kept)
        assert browser.run(f"{state}.layers.xray")
        assert browser.run("document.getElementById('bodies').open")
        assert "KF402" in browser.run("document.getElementById('findings').textContent")
        assert [line for line in browser.said if "kinform" not in line] == []
    finally:
        browser.close()
