"""A web page to explore motions: `symosc explore`.

The page has no memory of its own: its state is its link, and each answer is made from the link
alone (`answers`). `server` hands out the page, its plots, its answers and scene files, on this
machine only. The folder `page` has the page itself.
"""
