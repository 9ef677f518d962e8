"""The page's view of the assembly: what is drawn, and how to press and switch."""

from __future__ import annotations

import numpy as np

DRAWN = """(() => {
  const stage = document.getElementById('stage'), flat = document.createElement('canvas');
  flat.width = 160; flat.height = 100;
  const paint = flat.getContext('2d', {willReadFrequently: true});
  paint.drawImage(stage, 0, 0, 160, 100);
  return Array.from(paint.getImageData(0, 0, 160, 100).data);
})()"""


def drawn(browser):
    """The canvas as (100, 160, 3) numbers."""
    browser.settle()
    return np.array(browser.run(DRAWN)).reshape(100, 160, 4)[..., :3]


def inside(browser, selector, across=0.5, down=0.5):
    """A place within an element, in pixels of the window, after it was scrolled into view."""
    browser.run(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center', behavior: 'instant'}})")
    browser.settle()
    box = browser.run(
        f"(() => {{ const b = document.querySelector({selector!r}).getBoundingClientRect(); "
        "return [b.left, b.top, b.width, b.height]; })()"
    )
    return box[0] + across * box[2], box[1] + down * box[3]


def press(browser, selector):
    """Click on an element, after what it is folded in was opened."""
    browser.run(
        f"(() => {{ for (let box = document.querySelector({selector!r}); box; box = box.parentElement)"
        " if (box.tagName === 'DETAILS') box.open = true; })()"
    )
    browser.click(*inside(browser, selector))


def layer(browser, name, on):
    """Switch a layer."""
    if browser.run(f"document.querySelector('[data-layer={name}]').checked") != on:
        press(browser, f"[data-layer={name}]")
