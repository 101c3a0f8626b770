"""The page of ``rodsim view``: what is in it, and in a browser, without a network, what it does."""

import base64
import json
import re
import shutil
import zlib

import numpy as np
import pytest
from calls import command, told
from outputs import CASE, POINTS, RODS, TIMES, create, frame
from scenes import CONFIGS

from rodsim import open_trajectory

pytest.importorskip("k3d", reason="needs the extra view")
msgpack = pytest.importorskip("msgpack")
pytest.importorskip("matplotlib")

RADIUS = 0.037
SINGLE = 1e-6  # K3D's numbers are single precision


def shown(index):
    """Return the random numbers of a frame, with triads that are some: turned at random."""
    fields, observables = frame(index)
    random = np.random.default_rng(100 + index)
    triads = np.linalg.qr(random.normal(size=(POINTS, 3, 3)))[0]
    triads *= np.linalg.det(triads)[:, None, None]
    fields["director"] = np.moveaxis(triads, 0, -1)
    return fields, observables


def write(writer, frames):
    for index in frames:
        writer.write_frame(index, index, *shown(index))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Six frames of random numbers: two rods, the second closed, seven tracers."""
    folder = tmp_path_factory.mktemp("page")
    with create(folder / "out.h5") as writer:
        write(writer, range(len(TIMES)))
        writer.finish("finished", {})
    assert "6 frames" in told("view", folder / "out.h5", "--radius", RADIUS)
    return folder / "out.html"


def contents(page):
    """Return K3D's objects in a page, and what our panel is told, as K3D's own page reads them."""
    text = page.read_text(encoding="utf-8")
    data = base64.b64decode(re.search(r"var data = '([^']*)'", text)[1])
    panel = json.loads(re.search(r"^\s*const RUN = (.*);$", text, re.M)[1])
    return msgpack.unpackb(zlib.decompress(data), strict_map_key=False)["objects"], panel


def array(packed):
    return np.frombuffer(packed["data"], packed["dtype"]).reshape(packed["shape"])


def with_end(values, rod):
    values = values[rod.nodes]
    return np.concatenate([values, values[:1]]) if rod.closed else values


def test_rods_are_tubes_along_their_points_in_every_frame(page):
    objects, panel = contents(page)
    by_id = {thing["id"]: thing for thing in objects}
    assert [rod["name"] for rod in panel["rods"]] == ["zeta", "alpha"]
    assert panel["times"] == TIMES.tolist()
    for rod, panelled, stripe in zip(RODS, panel["rods"], panel["stripes"], strict=True):
        tube, stripe = by_id[panelled["object"]], by_id[stripe]
        assert tube["width"] == pytest.approx(RADIUS, rel=SINGLE)
        assert panelled["points"] == rod.count + rod.closed
        for k in range(len(TIMES)):
            fields = shown(k)[0]
            line, first = fields["position"].T, fields["director"][0].T
            drawn = array(tube["vertices"][str(k)])
            np.testing.assert_allclose(drawn, with_end(line, rod), rtol=SINGLE, atol=SINGLE)
            drawn = array(stripe["vertices"][str(k)])
            beside = with_end(line + RADIUS * first, rod)
            np.testing.assert_allclose(drawn, beside, rtol=SINGLE, atol=10 * SINGLE)


def test_colours_are_the_twist_of_each_rod(page):
    from rodsim.analysis.strain import strain_twist

    panel = contents(page)[1]
    scale = panel["scales"]["twist"]
    low, high = (float(text.split()[0]) for text in scale["ends"])
    assert low == -high  # the numbers have both signs
    for rod, text in zip(RODS, scale["values"], strict=True):
        shades = np.frombuffer(base64.b64decode(text), np.uint8).reshape(len(TIMES), -1)
        for k in range(len(TIMES)):
            triads = shown(k)[0]["director"].transpose(2, 0, 1)[rod.nodes]
            twist = strain_twist(triads, rod.spacing, rod.closed)[:, 2]
            inner = 0.5 * (twist[1:] + twist[:-1])
            drawn = low + (high - low) * shades[k, 1 : 1 + len(inner)] / 255
            # a shade is 1/255 of the scale, its ends are told with three digits
            np.testing.assert_allclose(drawn, inner, atol=(high - low) * (0.5 / 255 + 5e-3))


def test_nothing_comes_from_elsewhere_and_a_title_cannot_end_the_script(page, tmp_path):
    text = page.read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=", text)
    assert not re.findall(r"@import|url\(['\"]?https?:", text)
    evil = "</script><script>alert(1)</script>"
    case = type(CASE)("", json.dumps({"title": evil}), [])
    with create(tmp_path / "evil.h5", case=case) as writer:
        write(writer, range(1))
    told("view", tmp_path / "evil.h5", "--radius", RADIUS, "-q")
    assert evil not in (tmp_path / "evil.html").read_text(encoding="utf-8")
    assert contents(tmp_path / "evil.html")[1]["title"] == evil


def test_a_page_is_refused_with_the_reason(tmp_path):
    create(tmp_path / "none.h5").finish("stopped", {})
    result = command("view", tmp_path / "none.h5", code=4)
    assert "has no frames yet" in result.stderr
    result = command("view", tmp_path / "none.h5", "-o", "a.png", code=2)
    assert "must end in one of .html" in result.stderr


# In a browser

FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--window-size=1100,700",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)  # fmt: skip
SURFACE = """
const done = arguments[1];
K3DInstance.then((k3d) => {
  const found = k3d.getWorld().ObjectsById[arguments[0]].geometry.attributes.position.array;
  done(Array.from(found));
});"""
MOVE = """
const slider = document.getElementById("frame");
slider.value = arguments[0];
slider.dispatchEvent(new Event("input"));"""
CHOOSE = """
const list = document.getElementById("colour");
list.value = arguments[0];
list.dispatchEvent(new Event("change"));"""
SETTLED = """
const done = arguments[0];
requestAnimationFrame(() => requestAnimationFrame(done));"""


@pytest.fixture(scope="module")
def browser():
    """Chromium without a screen and without a network."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium")
    program, driver = (shutil.which(name) for name in ("chromium", "chromedriver"))
    if not program or not driver:
        pytest.skip("needs chromium and chromedriver")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = webdriver.Chrome(options, webdriver.ChromeService(driver))
    opened.set_script_timeout(600)
    opened.set_page_load_timeout(600)
    yield opened
    opened.quit()


def visit(browser, page):
    from selenium.webdriver.support.ui import WebDriverWait

    browser.get(page.as_uri())
    ready = "return document.body.dataset.ready === 'yes'"
    WebDriverWait(browser, 600).until(lambda opened: opened.execute_script(ready))


def picture(browser):
    """Return what can be seen of the canvas, left of the panel: (height, width, 3)."""
    from io import BytesIO

    from PIL import Image

    browser.execute_async_script(SETTLED)
    seen = Image.open(BytesIO(browser.get_screenshot_as_png())).convert("RGB")
    panel = browser.find_element("id", "panel").location["x"]
    return np.array(seen)[:, :panel]


def check_no_error(browser):
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert severe == []
    names = "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    outside = [n for n in browser.execute_script(names) if not n.startswith(("blob:", "data:"))]
    assert outside == []


def surface_of(browser, thing):
    return np.reshape(browser.execute_async_script(SURFACE, thing), (-1, 3))


@pytest.mark.long
def test_the_slider_moves_the_tubes(browser, page):
    visit(browser, page)
    panel = contents(page)[1]
    pictures = []
    for k in (0, 4):
        browser.execute_script(MOVE, k)
        pictures.append(picture(browser))
        rod, thing = RODS[0], panel["rods"][0]["object"]
        line = frame(k)[0]["position"].T[rod.nodes]
        surface = surface_of(browser, thing)
        for point in line[[0, -1]]:  # the ends, where no bend makes a tube narrower
            nearest = np.linalg.norm(surface - point, axis=1)
            assert nearest[nearest > 0.5 * RADIUS].min() == pytest.approx(RADIUS, rel=1e-3)
        assert f"t = {TIMES[k]:g} s" in browser.find_element("id", "clock").text
    assert (pictures[0] < 200).any()  # something is drawn on white
    assert (pictures[0] != pictures[1]).any()
    browser.execute_script(CHOOSE, "twist")
    assert (picture(browser) != pictures[1]).any()
    check_no_error(browser)


@pytest.mark.long
@pytest.mark.compiled
@pytest.mark.parametrize(
    ("config", "end"),
    [("closed_ring", 0.1), ("two_flagella", 2e-3), ("swimmer_at_wall", 2e-3), ("bacterium", 1e-3)],
)
def test_shipped_scenes_open(browser, tmp_path, config, end):
    output = tmp_path / "out.h5"
    told("run", CONFIGS / f"{config}.yaml", "--set", f"time.end={end}", "-q", "-o", output)
    told("view", output, "-q")
    page = output.with_suffix(".html")
    assert page.stat().st_size < 5e6
    visit(browser, page)
    first = picture(browser)
    assert (first < 200).any()
    with open_trajectory(output) as run:
        last = run.frames - 1
        rod, line = run.rods[0], run.read("position", -1)[run.rods[0].nodes]
    browser.execute_script(MOVE, last)
    assert (picture(browser) != first).any()
    surface = surface_of(browser, contents(page)[1]["rods"][0]["object"])
    reach = line.max(axis=0) - surface.max(axis=0)
    assert (np.abs(reach) < 0.1 * rod.length).all()
    check_no_error(browser)
