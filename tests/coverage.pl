#!/usr/bin/env perl
# tests/coverage.pl FOLDER...: reads what gcov says (one JSON a line) and prints the branches taken in files below the
# folders, least covered decisions first, with the lines of those that no test took.
use strict;
use warnings;
use JSON::PP;

my %taken;    # file -> "line:place in the line" -> times
while (my $text = <STDIN>) {
    my $said = eval { decode_json($text) } or next;
    for my $file (@{$said->{files}}) {
        my ($folder) = grep { index("/$file->{file}", "/$_/") >= 0 } @ARGV or next;
        (my $name = $file->{file}) =~ s{^.*?(?=\Q$folder\E/)}{};
        for my $line (@{$file->{lines}}) {
            my @branches = @{$line->{branches}};
            my @kept;
            for my $i (0 .. $#branches) {
                next if $branches[$i]{throw} || $branches[$i]{fallthrough} && $i < $#branches && $branches[$i + 1]{throw};
                push @kept, $branches[$i]{count};
            }
            # One line of a header or a template counts once however many files it was compiled in.
            $taken{$name}{"$line->{line_number}:" . @kept . ":$_"} += $kept[$_] for 0 .. $#kept;
        }
    }
}
my (@rows, %all, %hit);
for my $name (sort keys %taken) {
    my @places = keys %{$taken{$name}};
    my @missed = grep { !$taken{$name}{$_} } @places;
    my %lines = map { (split /:/)[0] => 1 } @missed;
    push @rows, [scalar @missed, scalar @places, $name, join(" ", sort { $a <=> $b } keys %lines)];
    my ($folder) = grep { index("$name/", "$_/") == 0 } @ARGV;
    for my $sum ($folder, "all") {
        $all{$sum} += @places;
        $hit{$sum} += @places - @missed;
    }
}
printf "%-50s %4d of %4d missed: lines %s\n", $_->[2], $_->[0], $_->[1], $_->[3]
    for sort { $b->[0] <=> $a->[0] } grep { $_->[0] } @rows;
printf "branches taken in %-24s %5.1f %% of %d\n", $_, 100 * $hit{$_} / $all{$_}, $all{$_} for grep { $all{$_} } @ARGV, "all";
