"""The status page in a real browser over a live twin: logging in, seeing it move, STOP, a server that has gone."""

from __future__ import annotations

import shutil
import time

import pytest

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.client import Client
from trochia.controller.runtime import Runtime
from trochia.messages.command import Enable, JogBy, Load, Run
from trochia.server.desk import Desk
from trochia.server.doors import Doors
from trochia.server.listen import Served, listen
from trochia.server.rest import bring_to_rest
from trochia.server.users import Users

CHROMIUM = shutil.which("chromium")
sync_api = pytest.importorskip("playwright.sync_api", reason="the browser's driver, playwright, is not installed")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="Debian's chromium is not installed")

PASSWORD = "a password for tests"  # noqa: S105
PROGRAM = "G21 G90 G17 G64 P0.01\nF300\nG1 X40\nY40\nX0\nY0\nM2\n"
PATIENCE = 30_000  #: of the browser, on a busy computer [ms]


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture
def served(tmp_path):
    machine = trochia.load("reference-mill")
    users = Users(tmp_path / "users.json", cost=1 << 10)
    users.put("ada", "operator", PASSWORD)
    users.put("eve", "viewer", PASSWORD)
    runtime = Runtime(LiveTwin(machine), now=time.monotonic())
    socket = listen("127.0.0.1", 0)
    desk = Desk(runtime, users, Doors.of(socket.getsockname()[1]))
    runtime.start()
    made = Served(desk, socket)
    made.start()
    yield made
    made.close()
    bring_to_rest(runtime)
    desk.close()
    runtime.close()


@pytest.fixture
def opened(browser, served):
    """Open the page; at the end nothing may have been asked of another server, and no error logged but refusals."""
    pages, complaints, asked = [], [], []
    address = f"http://127.0.0.1:{served.port}/"

    def open_page(*, width=1100, height=900, scheme="light"):
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: complaints.append(said.text) if "Content Security" in said.text else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(address)
        pages.append(page)
        return page

    yield open_page
    for page in pages:
        page.context.close()
    assert complaints == []
    assert all(url.startswith((address, "data:")) for url in asked)


def log_in(page, user="eve", password=PASSWORD):
    page.get_by_label("Name").fill(user)
    page.get_by_label("Password").fill(password)
    page.get_by_role("button", name="Log in").click()


def has(page, selector, text):
    sync_api.expect(page.locator(selector)).to_contain_text(text, timeout=PATIENCE)


def test_a_viewer_logs_in_sees_it_run_and_stops_it(opened, served):
    page = opened()
    log_in(page, password=PASSWORD[1:])
    has(page, "#login-error", "name or password is wrong")
    log_in(page)
    has(page, "#state", "off")
    has(page, "#who", "eve (viewer), nobody has control")
    has(page, "#mover", "digital twin")
    with Client.connect(f"http://127.0.0.1:{served.port}", "ada", PASSWORD) as ada:
        ada.take()
        has(page, "#who", "ada has control")
        ada.command(Enable())
        ada.command(JogBy(way={"Y": 3.0}))
        has(page, "#axes tbody tr:nth-child(2) .work", "3.000")
        has(page, "#axes tbody tr:nth-child(2) th", "Ymm")
        has(page, "#axes tbody tr:nth-child(2) td.known", "yes")
        ada.command(Load(name="square.ngc", text=PROGRAM))
        ada.command(Run())
        has(page, "#state", "running")
        has(page, "#program", "square.ngc")
        has(page, "#facts", "of 7")
        page.get_by_role("button", name="STOP").click()
        ada.wait_until(lambda now: now.state == "estop" and not any(a.velocity for a in now.axes), timeout=30.0)
    has(page, "#state", "Emergency stop")
    has(page, "#alarms", "emergency")


def test_the_keyboard_reaches_stop(opened, served):
    page = opened()
    log_in(page)
    has(page, "#state", "off")
    page.locator("#stop").focus()
    page.keyboard.press("Enter")
    has(page, "#state", "Emergency stop")
    assert served.desk.runtime.status.state == "estop"


def test_it_says_when_there_is_no_news(opened, served):
    page = opened()
    log_in(page)
    has(page, "#state", "off")
    sync_api.expect(page.locator("#fresh")).to_be_empty(timeout=PATIENCE)
    served.close()
    has(page, "#fresh", "no news")
    assert page.locator("body.stale").count() == 1


def test_logging_out_shows_the_login_again(opened):
    page = opened()
    log_in(page, "ada")
    has(page, "#who", "ada (operator)")
    page.get_by_role("button", name="Log out").click()
    sync_api.expect(page.get_by_label("Password")).to_be_visible(timeout=PATIENCE)


def test_a_page_of_another_site_cannot_stop_or_read_the_machine(opened, served):
    page = opened()
    log_in(page)
    has(page, "#state", "off")
    other = page.context.new_page()
    other.route("http://evil.example/", lambda route: route.fulfill(body="<p>hello", content_type="text/html"))
    other.goto("http://evil.example/")
    tried = other.evaluate(
        """async (url) => {
          const stop = {method: "POST", mode: "no-cors", credentials: "include"};
          const post = await fetch(url + "/api/stop", stop).then(r => r.type, () => "failed");
          const read = await fetch(url + "/api/status", {credentials: "include"}).then(() => "read", () => "failed");
          const socket = await new Promise(done => {
            const s = new WebSocket(url.replace("http", "ws") + "/api/socket");
            s.onopen = () => done("open"); s.onerror = () => done("failed");
          });
          return [post, read, socket];
        }""",
        f"http://127.0.0.1:{served.port}",
    )
    other.close()
    assert tried[1:] == ["failed", "failed"]
    assert served.desk.runtime.status.state == "off"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_shows_it_without_scrolling_sideways_and_stop_stays(opened, scheme):
    page = opened(width=360, height=740, scheme=scheme)
    log_in(page)
    has(page, "#state", "off")
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    page.evaluate(
        "status.axes.forEach((axis) => { axis.work = axis.commanded = -123.456; axis.velocity = -123.4; }); draw()"
    )
    assert page.evaluate("(table => table.scrollWidth - table.clientWidth)(document.querySelector('.wide'))") <= 0
    page.mouse.wheel(0, 2000)
    box = page.locator("#stop").bounding_box()
    assert 0 <= box["y"] <= 60
    assert min(box["width"], box["height"]) >= 60
