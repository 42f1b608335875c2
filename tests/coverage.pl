#!/usr/bin/env perl
# tests/coverage.pl FOLDER...: reads what gcov says (one JSON a line) and prints the branches taken in files below the
# folders, least covered decisions first, with the lines of those that no test took. Lines without a word that decides
# have none: what gcov counts there destroys the parts of a list when an exception comes between them.
use strict;
use warnings;
use Cwd;
use JSON::PP;

my $root = getcwd();
my $decides = qr/\b(?:if|for|while|switch|case)\b|\?|&&|\|\|/;
my %source;   # file -> its lines
my %taken;    # file -> "line:place in the line" -> times
while (my $text = <STDIN>) {
    my $said = eval { decode_json($text) } or next;
    for my $file (@{$said->{files}}) {
        (my $name = $file->{file}) =~ s{^\Q$root\E/}{};
        next unless grep { index($name, "$_/") == 0 } @ARGV;
        $source{$name} ||= do { open(my $in, "<", $name) or die "$name: $!\n"; [<$in>] };
        for my $line (@{$file->{lines}}) {
            next if ($source{$name}[$line->{line_number} - 1] // "") !~ $decides;
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
