"""tools/draw_thumbnails.py: every example of the gallery has a thumbnail that needs no flight to be built."""

import re

import draw_thumbnails
import pytest
from PIL import Image

EXAMPLES = sorted(draw_thumbnails.EXAMPLES.glob("plot_*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_names_a_picture_that_is_there(example):
    named = re.findall(r"^# sphinx_gallery_thumbnail_path = '(.+)'$", example.read_text(), re.MULTILINE)
    assert len(named) == 1
    picture = draw_thumbnails.ROOT / "docs" / named[0]
    assert picture.is_file()
    if picture.suffix == ".png":
        assert named == [f"_static/gallery/{example.stem}.png"]
        with Image.open(picture) as image:
            assert image.size == (400, 280)
            assert len(image.convert("RGB").getcolors(200_000)) > 20, "it is not empty"


def test_it_draws_the_first_figure_and_leaves_nothing_behind(tmp_path, monkeypatch):
    (tmp_path / "plot_x.py").write_text(
        "import matplotlib.pyplot as plt\nopen('left.txt', 'w').close()\n"
        "plt.subplots()[1].plot([0, 1])\nplt.subplots()\n"
    )
    (tmp_path / "plot_y.py").write_text("print('no figure')\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(draw_thumbnails, "EXAMPLES", tmp_path)
    monkeypatch.setattr(draw_thumbnails, "TARGET", tmp_path / "thumbs")
    draw_thumbnails.main([])
    assert [path.name for path in (tmp_path / "thumbs").iterdir()] == ["plot_x.png"]
    assert not (tmp_path / "left.txt").exists()
