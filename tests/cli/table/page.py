"""Opens a page on the screen of a telephone: page.py ADDRESS"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../view"))
from browser import Browser  # noqa: E402

with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder) as browser:
    page = browser.open(sys.argv[1], 390, 844, touch=True)
    page.wait("document.readyState == 'complete' && !!document.querySelector('pre')")
    assert page.value("innerWidth") == 390, page.value("innerWidth")
    assert page.value("document.documentElement.scrollWidth") == 390, page.value("document.documentElement.scrollWidth")
    assert page.value("[...document.images].every(image => image.naturalWidth > 0)")
    report = page.value("(pre => [pre.clientWidth, pre.scrollWidth])(document.querySelector('pre'))")
    assert report[0] < report[1], report  # else this page tests nothing
