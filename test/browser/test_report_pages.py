"""Reports in a real browser: accessible at every size and scheme, drawn offline, zoomed together, data a click away."""

import urllib.parse

import pytest
from pages import SCHEMES, SIZES, small_gap, violations

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def gap_page(tmp_path_factory):
    return small_gap().to_html(tmp_path_factory.mktemp("pages") / "gap.html")


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", SIZES)
def test_a_report_is_accessible_and_silent(gap_page, visit, width, scheme):
    page, said = visit(gap_page.as_uri(), width, scheme)
    assert violations(page) == []
    assert said == []
    assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")


def test_a_page_with_every_plot_drawn_is_accessible(gap_page, visit):
    page, said = visit(gap_page.as_uri(), 768, "dark", every=True)
    assert page.evaluate("document.querySelectorAll('.canvas .plot-container').length") >= 7
    assert violations(page) == []
    assert said == []


def test_a_page_stays_below_five_megabytes_and_needs_no_network(gap_page, chromium):
    assert gap_page.stat().st_size < 5e6
    context = chromium.new_context(offline=True)
    page = context.new_page()
    page.goto(gap_page.as_uri())
    page.wait_for_function("document.documentElement.dataset.plots === 'ready'")
    assert page.evaluate("drawEveryPlot()") >= 7
    context.close()


def test_runs_zoom_together(gap_page, visit):
    page, _ = visit(gap_page.as_uri(), every=True)
    ranges = page.evaluate(
        """async () => {
          const runs = [...document.querySelectorAll('figure.plot[aria-label^="Run"] .canvas')];
          await Plotly.relayout(runs[0], {"xaxis.range[0]": 10, "xaxis.range[1]": 20});
          await new Promise((done) => setTimeout(done, 300));
          return runs.map((each) => each.layout.xaxis.range);
        }"""
    )
    assert len(ranges) == 5
    assert all(each == [10, 20] for each in ranges)


def test_the_data_behind_a_figure_are_a_click_away(gap_page, visit):
    page, _ = visit(gap_page.as_uri())
    link = page.locator('figure[aria-label^="Run"] a.csv').first
    link.focus()
    lines = urllib.parse.unquote(link.get_attribute("href")).partition(",")[2].splitlines()
    assert "gap after [N·m]" in lines[0]
    assert len(lines) > 200
    assert float(lines[1].split(",")[0]) < 1.0


def test_what_is_drawn_follows_the_scheme(gap_page, visit):
    page, _ = visit(gap_page.as_uri(), scheme="light", every=True)
    ink = "document.querySelector('.xtitle').style.fill"
    before = page.evaluate(ink)
    page.emulate_media(color_scheme="dark")
    page.wait_for_function(f"{ink} !== '{before}'")
