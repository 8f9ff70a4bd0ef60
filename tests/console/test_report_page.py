"""The report in a real browser: it draws, tells what is under the pointer, marks lines, zooms, and asks no network."""

from __future__ import annotations

import base64
import io
import itertools
import runpy
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from trochia.analysis.report import write_report
from trochia.analysis.report.reasons import Reason, Reasons

CHROMIUM = shutil.which("chromium")
sync_api = pytest.importorskip("playwright.sync_api", reason="the browser's driver, playwright, is not installed")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="Debian's chromium is not installed")

SPECIMEN = runpy.run_path(str(Path(__file__).parents[1] / "report_specimen.py"))
#: Distinct colours among the pixels of a canvas: a blank one has one.
COLOURS = """canvas => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""


def _reasons(data):
    """Return limits for a made-up motion: the feed, and bends in every other tenth of the time."""
    bends = (np.arange(len(data.samples.time)) * 10 // len(data.samples.time)) % 2
    labels = (("programmed feed", "feed"), ("axis X acceleration in a bend", "bend"))
    shares = [Reason(limit=words, group=group, seconds=data.time.motion / 2, share=0.5, beside_stops=0.0, used=1.0)
              for words, group in labels]  # fmt: skip
    return Reasons(shares=tuple(shares), labels=labels, sample=bends.astype(np.uint8), lines={})


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reports")
    flat, hostile = SPECIMEN["contour"](period=0.005), SPECIMEN["HOSTILE"]
    kinds = {
        "flat": flat,
        "deep": SPECIMEN["contour"](depth=True, over=True, period=0.005),
        "bound": replace(flat, reasons=_reasons(flat)),
        "planned": replace(flat, samples=None),
        "still": replace(flat, samples=None, programmed=None, line_times=None),
        "hostile": replace(
            flat, program=hostile, machine=hostile, problems=(replace(flat.problems[0], message=hostile),)
        ),
    }
    for name, data in kinds.items():
        write_report(folder / f"{name}.html", data)
    return folder


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture
def opened(browser, reports):
    """Open a report; at the end no error may have been logged and no address asked but the file's own."""
    pages, complaints, asked = [], [], []

    def open_report(name="flat", *, width=1400, height=1000, scheme="light"):
        page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("dialog", lambda dialog: complaints.append(dialog.message))
        page.on("request", lambda request: asked.append(request.url))
        page.goto((reports / f"{name}.html").as_uri())
        if page.locator("#path-base").is_visible():
            page.locator("#path-base").scroll_into_view_if_needed()
        settle(page)
        pages.append(page)
        return page

    yield open_report
    for page in pages:
        page.close()
    assert complaints == []
    assert {Path(url).suffix for url in asked if not url.startswith("data:")} == {".html"}


def settle(page):
    """Wait for two frames: a change asks for a drawing, the drawing comes with the next."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def wait_until(page, condition):
    """Look once a frame; the driver's own waiting evaluates text inside the page, which the page's policy forbids."""
    look = f"const look = () => {condition} ? done() : requestAnimationFrame(look)"
    page.evaluate(f"() => new Promise(done => {{ {look}; look(); }})")


def pixels(page, selector):
    """Return the canvas' pixels (height, width, 4), 0 to 1."""
    address = page.locator(selector).first.evaluate("canvas => canvas.toDataURL()")
    return imread(io.BytesIO(base64.b64decode(address.partition(",")[2])), format="png")


def same(one, other):
    """Say whether two drawings look alike; edges may differ by what a rasteriser rounds."""
    return one.shape == other.shape and float(np.abs(one - other).max()) < 0.05


def distinct(drawings):
    return not any(same(one, other) for one, other in itertools.combinations(drawings, 2))


def point_at_path(page):
    box = page.locator("#path-base").bounding_box()
    for share in range(5, 95):  # walk down a vertical line until the pointer means the path
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + share / 100 * box["height"])
        settle(page)
        if page.locator("#tip").is_visible():
            return
    pytest.fail("no place on the middle line of the picture means the path")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_everything_is_drawn(opened, scheme):
    page = opened(scheme=scheme)
    assert page.locator("#path-base").evaluate(COLOURS) > 50
    plots = page.locator(".plot canvas")
    assert plots.count() == 6
    for i in range(plots.count()):
        assert plots.nth(i).evaluate(COLOURS) > 10
    assert page.locator("h1").inner_text() == "contour.ngc"
    assert "It will run, with 2 warnings" in page.locator(".verdict").inner_text()


def test_a_program_that_was_only_planned_is_drawn_too(opened):
    page = opened("planned")
    assert page.locator("#path-base").evaluate(COLOURS) > 10
    assert page.locator(".plots").is_hidden()
    assert page.locator("#player").is_hidden()


def test_no_motion_is_said_in_words(opened):
    page = opened("still")
    assert page.locator("#path-empty").is_visible()
    assert page.locator("#stage").is_hidden()


def test_hostile_text_is_shown_and_not_run(opened):
    page = opened("hostile")
    hostile = SPECIMEN["HOSTILE"]
    name = hostile.rpartition("/")[2]
    assert page.locator("h1").inner_text() == name
    assert page.title() == f"{name} on {hostile} – Trochia"  # noqa: RUF001 - the title's dash
    assert hostile in page.locator(".problems").inner_text()


def test_pointing_at_the_path_tells_line_time_place_and_speed(opened):
    page = opened()
    point_at_path(page)
    tip, readout = page.locator("#tip").inner_text(), page.locator("#readout").inner_text()
    line = int(tip.split()[1])
    text = SPECIMEN["contour"]().text(line)
    assert text in tip
    for part in (f"line {line}", text, " s", "X ", "Y ", "mm/s"):
        assert part in readout
    assert page.locator(".plot .hair").first.is_visible()


def test_pointing_at_a_plot_marks_the_path(opened):
    page = opened()
    before = pixels(page, "#path-over")
    page.locator(".plot canvas").first.hover()
    settle(page)
    assert not same(pixels(page, "#path-over"), before)
    assert "line" in page.locator("#readout").inner_text()


def test_a_line_of_the_table_is_marked_on_path_and_plots(opened):
    page = opened()
    path, plot = pixels(page, "#path-over"), pixels(page, ".plot canvas")
    button = page.locator("#slow .line-link").nth(2)
    button.click()
    settle(page)
    assert button.get_attribute("aria-pressed") == "true"
    assert not same(pixels(page, "#path-over"), path)
    assert not same(pixels(page, ".plot canvas"), plot)
    assert f"line {button.inner_text()}" in page.locator("#readout").inner_text()
    button.click()
    assert button.get_attribute("aria-pressed") == "false"


def test_dragging_a_plot_zooms_and_a_double_click_shows_all(opened):
    page = opened()
    plot = page.locator(".plot canvas").first
    box = plot.bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 300, box["y"] + 40, steps=4)
    page.mouse.up()
    assert page.locator("#whole").is_enabled()
    plot.dblclick()
    assert page.locator("#whole").is_disabled()


def test_wheel_drag_and_fit_move_the_view(opened):
    page = opened()
    whole = pixels(page, "#path-base")
    box = page.locator("#path-base").bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.wheel(0, -400)
    settle(page)
    zoomed = pixels(page, "#path-base")
    page.mouse.down()
    page.mouse.move(box["x"] + 150, box["y"] + 160, steps=3)
    page.mouse.up()
    settle(page)
    assert distinct([whole, zoomed, pixels(page, "#path-base")])
    page.locator("#fit").click()
    settle(page)
    assert same(pixels(page, "#path-base"), whole)


def test_keys_alone_reach_the_path_and_the_cursor(opened):
    page = opened()
    whole = pixels(page, "#path-base")
    page.locator("#path-base").focus()
    page.keyboard.press("+")
    settle(page)
    assert not same(pixels(page, "#path-base"), whole)
    page.keyboard.press("f")
    settle(page)
    assert same(pixels(page, "#path-base"), whole)
    page.locator(".plot canvas").first.focus()
    page.keyboard.press("End")
    settle(page)
    assert page.locator("#time").input_value() == page.locator("#time").get_attribute("max")
    page.keyboard.press("+")
    assert page.locator("#whole").is_enabled()
    page.keyboard.press("Escape")
    assert page.locator("#whole").is_disabled()


def test_speeds_change_their_unit_everywhere(opened):
    page = opened()
    page.get_by_role("button", name="mm/min", exact=True).click()
    settle(page)
    assert page.locator("#legend-high").inner_text() == "1980"
    assert "mm/min" in page.locator(".chart-head .unit").first.inner_text()
    assert "2400" in page.locator(".peaks tbody tr").first.inner_text()


def test_depth_offers_planes_and_a_view_all_round(opened):
    page = opened("deep")
    assert page.locator("#planes button").all_inner_texts() == ["XY", "XZ", "YZ", "3D"]
    views = []
    for name in ("XY", "XZ", "YZ", "3D"):
        page.get_by_role("button", name=name, exact=True).click()
        settle(page)
        views.append(pixels(page, "#path-base"))
    box = page.locator("#path-base").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 160, steps=3)
    page.mouse.up()
    settle(page)
    assert distinct([*views, pixels(page, "#path-base")])
    assert "It will not run: 1 error" in page.locator(".verdict").inner_text()


def test_playing_moves_the_cursor(opened):
    page = opened()
    page.locator("#play").click()
    wait_until(page, "Number(document.querySelector('#time').value) > 0.05")
    page.locator("#play").click()
    assert page.locator("#play").inner_text() == "Play"


@pytest.mark.parametrize("name", ["flat", "deep"])
def test_a_phone_shows_it_without_scrolling_sideways(opened, name):
    page = opened(name, width=360, height=740)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    assert page.locator("#path-base").bounding_box()["height"] >= 300


def test_it_prints(opened):
    page = opened(scheme="dark")
    printed = page.pdf()
    assert printed.startswith(b"%PDF")
    assert len(printed) > 20_000


def test_the_path_is_coloured_by_what_binds(opened):
    page = opened("bound")
    by_speed = pixels(page, "#path-base")
    assert page.locator("#limit-legend").is_hidden()
    page.get_by_role("button", name="What binds").click()
    settle(page)
    assert distinct([by_speed, pixels(page, "#path-base")])
    assert page.locator("#legend").is_hidden()
    assert "bends 50 %" in page.locator("#limit-legend").inner_text()
    point_at_path(page)
    assert "bound by" in page.locator("#readout").inner_text()
    page.get_by_role("button", name="Speed", exact=True).click()
    settle(page)
    assert page.locator("#legend").is_visible()


def test_a_motion_without_reasons_has_no_such_colours(opened):
    assert opened("flat").locator("#colours").is_hidden()
