# Takes the program out of a document: its blocks of C, up to the one that has main.
#
#     awk -f tools/example.awk README.md > example.c
#
# SPDX-License-Identifier: MIT
$0 == "```c" { inside = 1; next }
$0 == "```" { inside = 0; if (complete) exit }
inside && /^int main\(/ { complete = 1 }
inside
