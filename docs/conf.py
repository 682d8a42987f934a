"""The documentation site: `nox -s docs` builds it, and a warning is an error.

Pages with `file_format: mystnb` are run at the build, each in a process of its own. Blocks
`{console}` are shell commands that are run as well. So no number and no figure of a page is pasted.
"""

from __future__ import annotations

import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

import symosc

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

import api  # noqa: E402  it is in the folder that was just named

# The programs of this environment come first in the commands of pages; nothing is coloured.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
os.environ["NO_COLOR"] = "1"
# Pages run as for everybody: without one's own settings of IPython, and without its warnings about
# a network.
ipython = tempfile.mkdtemp(prefix="symosc-docs-")
atexit.register(shutil.rmtree, ipython, ignore_errors=True)
os.environ["IPYTHONDIR"] = ipython
Path(ipython, "profile_default").mkdir()
Path(ipython, "profile_default", "ipython_kernel_config.py").write_text(
    "c.IPKernelApp.log_level = 40\n"
)

project = "symosc"
author = "the symosc developers"
copyright = "the symosc developers"
version = release = symosc.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_design",
    "api",
    "console",
    "gallery",
    "mathml",
    "wide",
]
exclude_patterns = ["_build", "**/.ipynb_checkpoints"]
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext"}
default_role = "py:obj"
pygments_style = "tango"

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist", "substitution"]
myst_heading_anchors = 3
if os.environ.get("SYMOSC_DOCS_CACHE"):
    nb_execution_mode = "cache"
else:
    nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # seconds, on a machine that others use, too
nb_merge_streams = True
nb_render_markdown_format = "myst"
myst_substitutions = api.pages()

autodoc_default_options = {
    "members": True,
    "inherited-members": "tuple,list,BaseException,ImportError,OSError",
}
toc_object_entries_show_parents = "hide"
smartquotes = False  # two dashes are two dashes
autodoc_typehints = "none"
autosummary_generate = False
numpydoc_show_class_members = False

html_theme = "pydata_sphinx_theme"
html_context = {"default_mode": "auto"}
html_title = "symosc"
html_static_path = ["_static", "../symosc/derive/fonts"]
html_css_files = ["symosc.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "header_links_before_dropdown": 8,
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": ["sphinx-version"],
    "show_toc_level": 2,
    "navigation_with_keys": False,
}
html_sidebars = {
    page: [] for page in ("index", "quickstart", "tasks", "gallery", "changes", "citing")
}
copybutton_prompt_text = r"\$ |>>> |\.\.\. "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True
