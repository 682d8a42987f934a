"""Read solutions of any kind: files, tables, results of solvers, functions.

Anything becomes named columns, then the names are matched, then the columns become samples and
events. `files` opens a file and finds the reader of its format, in `formats` or `text`; `objects`
turns Python objects into columns; `tables` holds the columns, with states and structs taken apart;
`names` says which column is which; `solutions` makes samples of them. A new format is a function in
`formats` and its line in FORMATS of `files`; a new name is a word in SYNONYMS of `names`.
"""
