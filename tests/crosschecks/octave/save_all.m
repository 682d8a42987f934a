% Made the files beside it, with GNU Octave 7.3: octave-cli save_all.m
t = (0:11)' / 8; x = t .^ 2; v = 2 * t;
words = char("stick", "slip"); name = "run 1"; flag = true; none = []; n = 5; z = 1 + 2i; cube = zeros(2, 2, 2);
small = int32([1 2]); many = {1, "two", [3 4]}; deep.a.b = t; S = sparse([1 0 2]);
save("samples.txt", "words", "name", "flag", "none", "n", "z", "cube", "small", "many", "deep", "S", "t", "x", "v");
save("-hdf5", "samples.h5", "words", "name", "flag", "none", "n", "z", "cube", "small", "many", "deep", "t", "x", "v");
sol.t = t; sol.x = x; sol.v = v;
save("struct.mat", "sol"); save("-hdf5", "struct.h5", "sol");
M = single([t x v]);
save("-hdf5", "matrix.h5", "M");
t = 0:0.125:1.375; x = t .^ 2; v = 2 * t;
save("range", "t", "x", "v"); save("-hdf5", "range.h5", "t", "x", "v");
t = [1.5 2.25 9]; x = [-2 0.5 NaN]; kind = {"stick", "slip", "end"}; boundary = int32([1 2 0]);
save("events.txt", "t", "x", "kind", "boundary"); save("-hdf5", "events.h5", "t", "x", "kind", "boundary");
kind = char(kind{:});
save("-7", "events.mat", "t", "x", "kind", "boundary");
save("chars.txt", "t", "x", "kind", "boundary"); save("-hdf5", "chars.h5", "t", "x", "kind", "boundary");
