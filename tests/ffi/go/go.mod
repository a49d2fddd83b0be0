module starcontour.invalid/ffi

go 1.18
