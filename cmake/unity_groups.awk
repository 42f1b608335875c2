# Puts sources into groups that may be compiled as one unit: two files that give one name to things of their own (in an
# unnamed namespace) never meet, since a call could then find the other file's function, and a file whose own name is one
# of a header of the room stays alone. Arguments: the room's headers, then its sources, in order.
# Prints a line a source: its group's number. -v most=N: sources a group at most.
function name_before(line) {  # what stands before the value, the arguments or the body
    sub(/[ ]*(=|\(|\{|\[|;).*$/, "", line)
    return match(line, /[A-Za-z_0-9]+$/) ? substr(line, RSTART, RLENGTH) : ""
}
function finish_file(    g, n, free, alone) {
    if (file ~ /\.cpp$/) {
        for (n in names) if (n in declared) alone = 1
        for (g = alone ? 1000 + count : 0; ; ++g) {
            free = size[g] < most
            for (n in names) if (free && ((g, n) in taken || (g, n) in used)) free = 0
            for (n in uses) if (free && (g, n) in taken) free = 0
            if (free) break
        }
        ++size[g]; ++count
        for (n in names) taken[g, n] = 1
        for (n in uses) used[g, n] = 1
        print g
    }
    delete names
    delete uses
    inside = 0
}
FNR == 1 { finish_file(); file = FILENAME }
file ~ /\.h$/ {
    if ((/^[A-Za-z_\[].*[a-z_0-9]\(/ || /^inline constexpr /) && !/^(using|namespace|template|inline namespace)/) {
        line = $0
        sub(/^\[\[[a-z_]+\]\] /, "", line)
        declared[name_before(line)] = 1
    } else if (/^(struct|class|enum class) [A-Za-z_0-9]+.*\{/) {
        declared[$1 == "enum" ? $3 : $2] = 1
    }
    next
}
/^namespace \{/ { inside = 1; next }
/^\}  \/\/ namespace$/ { inside = 0; next }
/^using [A-Za-z_0-9:]+::[A-Za-z_0-9]+;/ {
    line = $2
    sub(/;$/, "", line)
    sub(/^.*::/, "", line)
    uses[line] = 1
    next
}
inside && /^using [A-Za-z_0-9]+ =/ { names[$2] = 1; next }
!inside || /^(using|namespace|template|public|private|protected)/ || !/^[A-Za-z_\[]/ { next }
{
    line = $0
    sub(/^\[\[[a-z_]+\]\] /, "", line)
    if (line ~ /^(struct|class|enum|union) /) {
        sub(/^(struct|class|enum class|enum|union) /, "", line)
        match(line, /^[A-Za-z_0-9]+/)
        names[substr(line, 1, RLENGTH)] = 1
        next
    }
    if ((name = name_before(line)) != "") names[name] = 1
}
END { finish_file() }
