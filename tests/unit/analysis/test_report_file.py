"""The file itself: one, whole, bounded, asking no network, and no text of the user's breaks out of its place."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.plots import path_picture
from trochia.analysis.report import MotionSamples, ProgrammedPath, render_report, write_report
from trochia.analysis.report.payload import PATH_POINTS, SAMPLES, payload


@pytest.fixture(scope="module")
def page(contour):
    return render_report(contour)


def embedded(text):
    found = re.search(r'<script type="application/json" id="payload">(.*?)</script>', text, re.DOTALL)
    return json.loads(found.group(1))


def test_nothing_is_fetched(page):
    assert not re.findall(r"https?://|@import|\bsrc=|url\(", page)


def test_user_text_stays_text(contour, hostile, page):
    assert "<script>alert" not in page
    assert page.count("</script") == 2  # the data's and the program's own
    data = replace(contour, program=hostile, machine=hostile, machine_description=hostile)
    named = render_report(data)
    assert "<script>alert" not in named
    shown = html.unescape(re.search(r'class="machine">(.*?)</p>', named).group(1))
    assert shown == f"on <strong>{hostile}</strong><span> – {hostile}</span>"  # noqa: RUF001 - the page's dash


def test_the_report_names_the_file_without_its_folders(contour):
    assert "<h1>part.ngc</h1>" in render_report(replace(contour, program="/home/ada/secret/part.ngc"))


def test_hostile_source_survives_the_way_to_the_page(contour, hostile):
    data = replace(contour, problems=(replace(contour.problems[0], line=2),))
    assert embedded(render_report(data))["lines"]["2"] == hostile


def test_the_policy_admits_exactly_this_script(page):
    script = re.search(r'<script type="module">(.*?)</script>', page, re.DOTALL).group(1)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in html.unescape(page)


def test_arrays_come_back_as_they_were(contour):
    packed = payload(contour)["programmed"]["position"][0]
    assert packed["type"] == "f4"
    values = np.frombuffer(base64.b64decode(packed["data"]), "<f4")
    np.testing.assert_allclose(values, contour.programmed.points[:, 0], rtol=1e-6)


def test_a_million_moves_still_fit(contour):
    count = 1_000_000
    time = np.arange(count) * 0.001
    place = np.column_stack((100 * np.sin(time), 100 * np.cos(0.37 * time)))
    samples = MotionSamples(time=time, position=place, velocity=place, acceleration=place, speed=np.abs(place[:, 0]),
                            line=np.arange(1, count + 1), actual=place + 0.01, contour_error=time)  # fmt: skip
    programmed = ProgrammedPath(points=place, rapid=np.arange(count) % 50 == 0, line=np.arange(1, count + 1))
    data = replace(contour, source=["G1 X12.3456 Y23.4567"] * count, samples=samples, programmed=programmed)
    text = render_report(data)
    assert len(text) < 4.2e6
    shown = embedded(text)
    assert len(base64.b64decode(shown["path"]["speed"]["data"])) // 4 <= PATH_POINTS
    speed = np.frombuffer(base64.b64decode(shown["channels"]["speed"]["data"]), "<f4")
    assert len(speed) <= SAMPLES
    assert speed.max() == np.float32(samples.speed.max())


NOTHING = np.zeros((0, 2))
AT_NO_TIME = MotionSamples(time=NOTHING[:, 0], position=NOTHING, velocity=NOTHING, acceleration=NOTHING,
                           speed=NOTHING[:, 0], line=np.zeros(0, np.int64), actual=NOTHING)  # fmt: skip
NOWHERE = ProgrammedPath(points=NOTHING, rapid=np.zeros(0, np.bool_), line=np.zeros(0, np.int64))


@pytest.mark.parametrize(
    "bare",
    [
        {"samples": None},
        {"samples": None, "programmed": None, "line_times": None},
        {"samples": AT_NO_TIME, "programmed": NOWHERE, "line_times": None},
    ],
)
def test_a_job_that_never_ran_has_a_report_too(contour, bare, tmp_path):
    data = replace(contour, ok=False, problems=(), **bare)
    assert "It will not run" in render_report(data)
    path_picture(tmp_path / "path.png", data)
    assert (tmp_path / "path.png").read_bytes().startswith(b"\x89PNG")


def test_written_whole_or_not_at_all(contour, tmp_path):
    path = tmp_path / "report.html"
    path.write_text("before")
    with pytest.raises(OSError, match="missing"):
        write_report(tmp_path / "missing" / "report.html", contour)
    broken = replace(contour, feed_length=float("nan"), time=replace(contour.time, motion=float("nan")))
    with pytest.raises(ValueError, match="NaN"):
        write_report(path, replace(broken, path_velocity=float("nan")))
    assert path.read_text() == "before"
    write_report(path, contour)
    assert path.read_text(encoding="utf-8").endswith("</html>")
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_the_picture_is_wide_and_not_blank(contour, tmp_path):
    from matplotlib.image import imread  # noqa: PLC0415 - heavy

    path_picture(tmp_path / "path.png", contour)
    pixels = imread(tmp_path / "path.png")[..., :3]
    assert pixels.shape[1] == 1600
    coloured = np.ptp(pixels, axis=2) > 0.3
    assert coloured.mean() > 0.01
