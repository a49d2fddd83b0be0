# Plants one fault of tests/mutants/faults.txt in a tree, or lists them.
#
#     awk -f plant.awk -v name=NAME -v root=FOLDER faults.txt     changes files below FOLDER, prints them
#     awk -f plant.awk -v root=FOLDER faults.txt                  plants each, and changes nothing
#     awk -f plant.awk faults.txt                                 prints NAME and tests to try, a line each;
#                                                                 before these needs:INSTRUCTIONS, if any
#
# Exit status 1, and nothing is changed, if there is no such fault, or if lines that it replaces are
# not in their file, or are there more than once; each such fault is named.
#
# SPDX-License-Identifier: MIT

function fail(text) {
    printf "fault %s: %s\n", name == "" ? fault : name, text | "cat >&2"
    failed = 1
    if (name != "") exit 1
}

# Reads a file into lines, once; 0 if it cannot be read.
function load(file,    path, n) {
    if (file in length_of) return length_of[file]
    path = root "/" file
    n = 0
    while ((getline text < path) > 0) {
        line[file, ++n] = text
        original[file, n] = text
    }
    close(path)
    if (n == 0) return 0
    length_of[file] = original_length[file] = n
    files[++file_count] = file
    return n
}

# Replaces the lines out[1 .. out_count] of a file by into[1 .. into_count].
function replace(file,    i, k, at, found, n) {
    if (out_count == 0) {
        fail("replaces nothing in " file)
        return
    }
    if (!load(file)) {
        fail("cannot read " file)
        return
    }
    for (i = 1; i + out_count - 1 <= length_of[file]; i++) {
        for (k = 1; k <= out_count; k++)
            if (line[file, i + k - 1] != out[k]) break
        if (k > out_count) {
            at = i
            found++
        }
    }
    if (found != 1) {
        fail((found + 0) " places instead of one in " file " for: " out[1])
        return
    }
    n = 0
    for (i = 1; i < at; i++) changed[++n] = line[file, i]
    for (k = 1; k <= into_count; k++) changed[++n] = into[k]
    for (i = at + out_count; i <= length_of[file]; i++) changed[++n] = line[file, i]
    for (i = 1; i <= n; i++) line[file, i] = changed[i]
    length_of[file] = n
    touched[file] = 1
}

# Of all faults each is planted in the same lines.
function restore(    file, i) {
    for (file in touched) {
        for (i = 1; i <= original_length[file]; i++) line[file, i] = original[file, i]
        length_of[file] = original_length[file]
        delete touched[file]
    }
}

function finish_edit() {
    if (editing != "") replace(editing)
    editing = ""
    out_count = into_count = 0
}

function finish_fault() {
    if (root == "" && fault != "") print fault (tests == "" ? "" : " " tests)
    if (root != "" && (name == "" || fault == name)) finish_edit()
    if (root != "" && name == "") restore()
    tests = ""
}

/^#/ || /^$/ { next }
/^@ / {
    finish_fault()
    fault = $2
    if (fault == name) seen++
    next
}
/^\? / {
    tests = "needs:" $2
    next
}
/^> / {
    tests = tests (tests == "" ? "" : " ") substr($0, 3)
    next
}
root == "" || (name != "" && fault != name) { next }
/^-/ {
    if (into_count) fail("lines to put in come before lines to take out")
    out[++out_count] = substr($0, 2)
    next
}
/^\+/ {
    into[++into_count] = substr($0, 2)
    next
}
/^[a-z]+\/[a-z0-9_\/]+\.[ch]$/ {
    finish_edit()
    editing = $0
}

END {
    if (failed && name != "") exit 1
    finish_fault()
    if (failed) exit 1
    if (root == "" || name == "") exit 0
    if (seen != 1) fail((seen + 0) " faults of this name")
    if (file_count == 0) fail("changes nothing")
    for (k = 1; k <= file_count; k++) {
        path = root "/" files[k]
        printf "" > path
        for (i = 1; i <= length_of[files[k]]; i++) print line[files[k], i] > path
        close(path)
        print files[k]
    }
}
