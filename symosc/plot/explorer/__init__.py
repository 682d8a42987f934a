"""A page in the browser to try out motions: `symosc explore`.

The page has no memory of its own: its state is its link, and each answer is made from the link alone.

- `inputs`: the numbers of the page as texts, as a link and as a scene, and what is wrong with them;
- `answer`: what the page shows for a link, as plain values;
- `pictures`: the plots, empty, as models of bokeh; the browser fills in the values of an answer;
- `server`: hands out the page, its answers and scene files, on this machine only.

The folder `page` has the page itself. One more number: a field in `inputs`. One more curve: a column in `answer` and a
glyph in `pictures`.
"""
