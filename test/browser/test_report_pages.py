"""Reports in a real browser: accessible at every size and scheme, drawn offline, zoomed together, data a click away."""

import urllib.parse

import pytest
from pages import COVERED, DESK, INK, KINDS, OF_COLOURS, PHONE, SCHEMES, TABLET, keep_screenshot, small_gap, violations

pytestmark = pytest.mark.browser
INKS = "[...document.querySelectorAll('.canvas')].filter((c) => c.layout).map((c) => c.layout.font.color)"

# what a reader cannot see without finding out that it scrolls: a title wider than its card, a legend with a scroll bar
CUT_OFF = """[
    ...[...document.querySelectorAll(".caption, p, li, dd, h2, h3, figcaption")].filter((each) =>
        each.scrollWidth > each.clientWidth + 1 || each.getBoundingClientRect().right > innerWidth),
    ...[...document.querySelectorAll(".legend .scrollbar")].filter((each) => +each.getAttribute("height") > 0)
].map((each) => each.outerHTML.slice(0, 120))"""


# tables that go on to the right and do not fade out there, and those that fade though all is seen
UNSEEN = """[...document.querySelectorAll(".scroll")].filter((each) =>
    each.checkVisibility() &&
    (each.scrollWidth - each.clientWidth - each.scrollLeft > 2) !== (getComputedStyle(each).maskImage !== "none")
).map((each) => each.getAttribute("aria-label"))"""


@pytest.fixture(scope="module")
def gap_page(tmp_path_factory):
    return small_gap().to_html(tmp_path_factory.mktemp("pages") / "gap.html")


@pytest.fixture(scope="module", params=KINDS)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def path(kind, tmp_path_factory, request):
    """The page of a kind, made once for all sizes."""
    made = request.getfixturevalue("gap_page") if kind == "gap" else KINDS[kind](tmp_path_factory.mktemp("pages"))
    assert made.stat().st_size < 5e6
    return made


def test_every_report_is_accessible_silent_and_drawn(kind, path, visit):
    """Opened on a desk, then as wide as a phone is: layout and plots follow whoever narrows the window."""
    page, said = visit(path.as_uri(), DESK, SCHEMES[0])
    assert page.inner_text("section h2 >> nth=0") in ("Decision", "Result")
    assert_drawn(page)
    assert page.locator("figure:not(.plot)").count() == 0  # no still picture is left
    assert_fits_and_is_accessible(page, kind, DESK)
    page.set_viewport_size({**page.viewport_size, "width": PHONE})
    assert_fits_and_is_accessible(page, kind, PHONE)
    assert said == []


@pytest.mark.long
@pytest.mark.parametrize("width", [TABLET, PHONE])
def test_every_report_opens_at_every_width(kind, path, visit, width):
    """From the start as wide as a tablet or a phone."""
    page, said = visit(path.as_uri(), width, SCHEMES[0])
    assert_drawn(page)
    assert_fits_and_is_accessible(page, kind, width)
    assert said == []


def assert_drawn(page):
    drawn = page.evaluate("globalThis.drawEveryPlot ? drawEveryPlot() : 0")
    page.wait_for_function(f"document.querySelectorAll('.canvas .plot-container').length === {drawn}")
    assert drawn >= 1


def assert_fits_and_is_accessible(page, kind, width):
    """In both schemes, changed while somebody looks, as a desktop does in the evening."""
    for scheme in SCHEMES:
        page.emulate_media(color_scheme=scheme)
        page.wait_for_function(f"{INKS}.every((ink) => ink === {INK[scheme]!r})")
        assert violations(page, OF_COLOURS if scheme != SCHEMES[0] else None) == []
        keep_screenshot(page, kind, width, scheme)
    page.wait_for_function(f"!{CUT_OFF}.length")
    assert page.evaluate(COVERED) == 0
    page.wait_for_function(f"!{UNSEEN}.length")
    page.evaluate("document.querySelectorAll('.scroll').forEach((each) => each.scrollTo(1e4, 0))")
    page.wait_for_function(f"!{UNSEEN}.length")
    assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")


def test_a_page_works_offline_with_every_plot_drawn(gap_page, chromium):
    """One page for all that needs every plot: size, no network, one zoom, the data, the scheme."""
    assert gap_page.stat().st_size < 5e6
    context = chromium.new_context(offline=True, color_scheme="light")
    page = context.new_page()
    page.goto(gap_page.as_uri())
    page.wait_for_function("document.documentElement.dataset.plots === 'ready'")
    assert page.evaluate("drawEveryPlot()") >= 7
    page.wait_for_function("document.querySelectorAll('.canvas .plot-container').length >= 7")
    assert_runs_zoom_together(page)
    assert_the_data_are_a_click_away(page)
    assert_the_scheme_is_followed(page)
    context.close()


def assert_runs_zoom_together(page):
    ranges = page.evaluate(
        """async () => {
          const runs = [...document.querySelectorAll('figure.plot[aria-label^="Run"] .canvas')];
          await Plotly.relayout(runs[0], {"xaxis.range[0]": 10, "xaxis.range[1]": 20});
          const same = () => runs.every((each) => each.layout.xaxis.range[1] === 20);
          for (let k = 0; k < 100 && !same(); k++) await new Promise((done) => setTimeout(done, 50));
          return runs.map((each) => each.layout.xaxis.range);
        }"""
    )
    assert len(ranges) == 5
    assert all(each == [10, 20] for each in ranges)


def assert_the_data_are_a_click_away(page):
    link = page.locator('figure[aria-label^="Run"] a.csv').first
    link.focus()
    lines = urllib.parse.unquote(link.get_attribute("href")).partition(",")[2].splitlines()
    assert "gap after [N·m]" in lines[0]
    assert len(lines) > 200
    assert float(lines[1].split(",")[0]) < 1.0


def assert_the_scheme_is_followed(page):
    ink = "document.querySelector('.xtitle').style.fill"
    before = page.evaluate(ink)
    page.emulate_media(color_scheme="dark")
    page.wait_for_function(f"{ink} !== '{before}'")
