"""The gallery of the manual: `python -m tests.support.gallery` makes it."""

from calib.car.effects.catalogue import CATALOGUE
from tests.support.gallery import PAGE, PICTURES


def test_every_effect_is_in_the_gallery_with_the_words_of_its_card():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name, one in CATALOGUE.items() if one.card.looks_like not in text] == []


def test_the_pictures_are_those_of_the_page_and_small():
    text, made = PAGE.read_text(encoding="utf-8"), sorted(PICTURES.iterdir())
    assert [one.stem for one in made] == sorted(n for n in CATALOGUE if f"/{n}.png" in text)
    assert sum(one.stat().st_size for one in made) < 400e3
