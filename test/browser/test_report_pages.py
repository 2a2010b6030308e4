"""Reports in a real browser: accessible at every size and scheme, drawn offline, zoomed together, data a click away."""

import urllib.parse

import pytest
from pages import SCHEMES, SIZES, check_page, demo_page, fleet_page, practice_page, small_gap, violations

import winch_friction as wf
from winch_friction.cli.main import run

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def gap_page(tmp_path_factory):
    return small_gap().to_html(tmp_path_factory.mktemp("pages") / "gap.html")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    run_ = wf.simulate("ahc_55t_215", crane, model, duration=30.0).run
    assert (
        run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads", "55", "--out", str(folder / "compare.html")])
        == 0
    )
    return wf.replay(run_, crane, model).to_html(folder / "replay.html"), folder / "compare.html"


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", SIZES)
def test_a_report_is_accessible_and_silent(gap_page, visit, width, scheme):
    page, said = visit(gap_page.as_uri(), width, scheme)
    assert violations(page) == []
    assert said == []
    assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")


def test_replay_and_comparison_are_accessible_too(pages, visit):
    for path, width, scheme in zip(pages, (420, 768), SCHEMES, strict=True):
        page, said = visit(path.as_uri(), width, scheme)
        assert violations(page) == []
        assert said == []


@pytest.fixture(scope="module", params=[practice_page, check_page, fleet_page, demo_page], ids=lambda f: f.__name__)
def other_page(request, tmp_path_factory):
    return request.param(tmp_path_factory.mktemp("pages"))


@pytest.mark.parametrize(("width", "scheme"), [(1400, "light"), (768, "dark"), (420, "light")])
def test_every_other_report_is_accessible_and_drawn(other_page, visit, width, scheme):
    assert other_page.stat().st_size < 5e6
    page, said = visit(other_page.as_uri(), width, scheme)
    assert page.inner_text("section h2 >> nth=0") in ("Decision", "Result")
    drawn = page.evaluate("globalThis.drawEveryPlot ? drawEveryPlot() : 0")
    page.wait_for_function(f"document.querySelectorAll('.canvas .plot-container').length === {drawn}")
    assert drawn >= 1
    assert page.locator("figure:not(.plot)").count() == 0  # no still picture is left
    assert violations(page) == []
    assert said == []
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
