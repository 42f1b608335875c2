#!/usr/bin/env perl
# Counts the sources of the product (core to studio): files, lines, lengths of files and functions (median, 95 %, longest),
# the largest group of files that include each other (a .cpp and its header are one), and numbers without a name. Prints
# only: goals stand in CONTRIBUTING.md, section Style. --long N: the functions of more than N lines, the longest first.
use strict;
use warnings;
use File::Basename;
use File::Spec;

chdir(dirname(File::Spec->rel2abs($0)) . "/../..") or die;
my @rooms = qw(core geometry postproc surrogates/tables surrogates/dynamics surrogates/estimator surrogates/discovery
               cases studio);
my $long = @ARGV == 2 && $ARGV[0] eq "--long" && $ARGV[1] =~ /^\d+$/ ? $ARGV[1] : undef;
die "count.pl [--long LINES]\n" if @ARGV && !defined $long;
my (%uses, @all_files, @all_functions, @long);

# Code without comments, text in quotes and preprocessor lines; line ends stay.
sub bare {
    my ($text) = @_;
    $text =~ s{//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'}{
        my $lines = $& =~ tr/\n//; ($& =~ m{^/} ? "" : "_") . "\n" x $lines}gsex;
    $text =~ s{^[ \t]*#(?:\\\n|[^\n])*}{my $lines = $& =~ tr/\n//; "\n" x $lines}gme;
    return $text;
}

# Functions, each with its lines, its first line and its head: a block in a namespace or class whose head has a parameter
# list.
sub functions {
    my ($code) = @_;
    my ($line, $head, $head_line, @blocks, @found) = (1, "", 1);
    for my $c (split //, $code) {
        $head_line = $line if $head !~ /\S/;
        if ($c eq "{") {
            my $outer = @blocks ? $blocks[-1][0] : "space";
            my $kind = $head =~ /\bnamespace\b|\bextern\b/ ? "space"
                : $head =~ /^\s*(?:template\s*<.*>\s*)?(?:class|struct|union|enum)\b/s && $head !~ /=\s*$/ ? "space"
                : $outer eq "space" && $head =~ /\)[^=]*$/s ? "function" : "block";
            push @blocks, [$kind, $head_line, $head];
            $head = "";
        } elsif ($c eq "}") {
            my $block = pop @blocks;
            push @found, [$line - $block->[1] + 1, @$block[1, 2]] if $block && $block->[0] eq "function";
            $head = "";
        } elsif ($c eq ";") {
            $head = "";
        } else {
            $head .= $c;
        }
        $line++ if $c eq "\n";
    }
    return @found;
}

# Numbers without a name: floating-point literals in the middle of an expression. Not counted, because nothing is decided
# by them or because they have a name where they stand:
#   - whole numbers below 100,000 however they are written (3, 3.0, 6561: counts, and coefficients of formulas), 0.5, and
#     1e3, 1e6 or 1e9 as a factor or divisor (millimetres, microseconds, nanoseconds of what is in SI);
#   - constants (const or constexpr), and what is given to a name as it is: x = 0.1 before , ; ) or }, which are
#     declarations, defaults, designated initialisers (.prior = 0.01) and fields (options.relative = 1e-9);
#   - rows of tables: a line of numbers, and what stands in braces with its name in quotes ({"mass", "kg", 1e-3, 5e3})
#     or in the row of a macro (ITEM(mass, ...)), whose columns the struct names;
#   - what part of the work is done: report(0.4, "...").
sub bare_numbers {
    my ($code) = @_;
    my $number = qr/(?:\d+\.\d*|\.\d+|\d+(?=[eE][-+]?\d))(?:[eE][-+]?\d+)?/;
    $code =~ s/\bconst(?:expr)?\b[^(;{}=]*(?:=[^;{}]*|(?:=\s*|\w)\{[^;()]*\});/;/g;
    $code =~ s/(?<=\w) = (\{(?:[-\d.eE+,\s]|(?1))*\})(?=\s*[,;)}])//g;
    $code =~ s/\{_, [^;{}()]*\}|\{-?$number, _\}|\bITEM\([^;]*;//g;
    $code =~ s/\breport\($number/report(/g;
    $code =~ s/(?<=\w) = -?$number(?=\s*[,;)}])//g;
    $code =~ s{\b1e[369] \*|[*/] 1e[369]\b}{}g;
    my $found = 0;
    for (split /\n/, $code) {
        next if /^[\s{}\d.,eE+-]+;?\s*$/;
        for my $literal (/(?<![\w.])($number)(?![\w.])/g) {
            $found++ unless $literal == int($literal) && $literal < 1e5 || $literal == 0.5;
        }
    }
    return $found;
}

sub quantile {
    my ($q, @values) = @_;
    @values = sort { $a <=> $b } @values;
    return @values ? $values[int($q * $#values + 0.5)] : 0;
}

# Groups of nodes that reach each other (Tarjan 1972).
my (%index, %low, %on_stack, @stack, @groups);
my $next = 0;
sub visit {
    my ($node) = @_;
    no warnings 'recursion';
    $index{$node} = $low{$node} = $next++;
    push @stack, $node;
    $on_stack{$node} = 1;
    for my $to (sort keys %{$uses{$node}}) {
        next unless exists $uses{$to};
        if (!defined $index{$to}) {
            visit($to);
            $low{$node} = $low{$to} if $low{$to} < $low{$node};
        } elsif ($on_stack{$to} && $index{$to} < $low{$node}) {
            $low{$node} = $index{$to};
        }
    }
    return if $low{$node} != $index{$node};
    my @group;
    while (defined(my $member = pop @stack)) {
        $on_stack{$member} = 0;
        push @group, $member;
        last if $member eq $node;
    }
    push @groups, \@group;
}

printf "%-22s %5s %7s  %-17s %-14s %s\n", "", "files", "lines", "file 50/95/max", "function", "numbers without a name per 1000 lines";
my ($all_files, $all_lines) = (0, 0);
for my $room (@rooms) {
    my (@files, @functions);
    my ($lines, $numbers) = (0, 0);
    for my $file (split /\n/, `git ls-files --cached --others --exclude-standard '$room/*.h' '$room/*.cpp'`) {
        open(my $in, "<", $file) or next;
        local $/;
        my $text = <$in>;
        my $length = $text =~ tr/\n//;
        $lines += $length;
        push @files, $length;
        my $code = bare($text);
        for my $function (functions($code)) {
            my ($length, $line, $head) = @$function;
            push @functions, $length;
            push @long, sprintf "%5d  %s:%d %s", $length, $file, $line, $head =~ /([\w:~]+)\s*\(/ ? $1 : ""
                if defined $long && $length > $long;
        }
        $numbers += bare_numbers($code);
        (my $node = $file) =~ s/\.(?:h|cpp)$//;
        $uses{$node} ||= {};
        while ($text =~ /^#include "([^"]+)\.h"/gm) {
            $uses{$node}{$1} = 1 if $1 ne $node;
        }
    }
    printf "%-22s %5d %7d  %-17s %-14s %.1f\n", $room, scalar @files, $lines,
        join("/", quantile(0.5, @files), quantile(0.95, @files), quantile(1, @files)),
        join("/", quantile(0.5, @functions), quantile(0.95, @functions), quantile(1, @functions)), 1000 * $numbers / $lines;
    push @all_files, @files;
    push @all_functions, @functions;
    $all_lines += $lines;
}
printf "%-22s %5d %7d  %-17s %-14s\n", "all", scalar @all_files, $all_lines,
    join("/", quantile(0.5, @all_files), quantile(0.95, @all_files), quantile(1, @all_files)),
    join("/", quantile(0.5, @all_functions), quantile(0.95, @all_functions), quantile(1, @all_functions));
visit($_) for grep { !defined $index{$_} } sort keys %uses;
my ($largest, @others) = sort { @$b <=> @$a } @groups;
printf "largest group of files that include each other: %d%s\n", scalar @$largest,
    @$largest > 1 ? " (" . join(", ", sort @$largest) . ")" : "";
printf "groups of more than four: %d\n", scalar grep { @$_ > 4 } @groups;
print "functions of more than $long lines: ", scalar @long, "\n", map { "$_\n" } sort { $b cmp $a } @long if defined $long;
