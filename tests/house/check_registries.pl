#!/usr/bin/perl
# Fails when a kind of thing that CONTRIBUTING.md says is one file and one line is named anywhere else: effects, importers,
# export formats, commands and steps of a study. What this finds for those that are there, a new one need not do.
use strict;
use warnings;
use Cwd qw(abs_path);
use File::Basename qw(dirname);
chdir(dirname(abs_path($0)) . "/../..") or die;

my $bad = 0;
sub slurp { my ($path) = @_; open(my $in, '<', $path) or die "$path: $!"; local $/; return scalar <$in>; }
my %code;
for my $file (split /\n/, `find core geometry postproc surrogates cases studio -name '*.h' -o -name '*.cpp'`) {
    ($code{$file} = slurp($file)) =~ s{//[^\n]*}{}g;
}

# Files that hold a pattern, less those where it belongs.
sub elsewhere {
    my ($kind, $pattern, $home, $own) = @_;    # $own: how many files of its own it may have
    my @files = grep { !$home->{$_} && $code{$_} =~ $pattern } sort keys %code;
    return if @files <= $own;
    print "$kind: named in @files, not in its own file and its line alone\n";
    $bad = 1;
}

sub listed { my ($file, $pattern) = @_; my @found = $code{$file} =~ /$pattern/g; die "$file lists nothing" unless @found > 2; return @found; }

# What decides by an effect's name would have to learn of a new one. "unknown" is a verdict as well.
for my $name (listed("surrogates/dynamics/effects/catalogue.h", qr/^\s*X\((\w+)\)/m)) {
    elsewhere("effect $name", qr/const Effect& ${name}_effect\(/, {}, 1);
    next if $name eq "unknown";
    for my $file (grep { m{^surrogates/discovery/} && $code{$_} =~ /"$name"/ } sort keys %code) {
        print "effect $name: named in $file\n";
        $bad = 1;
    }
    next if index(slurp("docs/conventions.md"), "`$name`") >= 0;
    print "effect $name: not in the table of docs/conventions.md\n";
    $bad = 1;
}
elsewhere("importer $_", qr/\b${_}_importer\b/, {"postproc/importers/registry.cpp" => 1}, 1)
    for listed("postproc/importers/registry.cpp", qr/^\s*X\((\w+),/m);
elsewhere("export $_", qr/\bvoid $_\(const ExportGrid/,
          {"surrogates/tables/exports/export_grid.h" => 1, "surrogates/tables/exports/export.cpp" => 1}, 1)
    for listed("surrogates/tables/exports/export.cpp", qr/^\s*(export_\w+)[,}]/m);
elsewhere("command $_", qr/\badd_${_}_command\b/, {}, 1) for listed("studio/cli/commands.h", qr/^\s*X\((\w+)\)/m);
elsewhere("step $_", qr/\bvoid $_\(Engine/, {"cases/engine.h" => 1, "cases/engine.cpp" => 1}, 1)
    for listed("cases/engine.cpp", qr/\{[\d.]+, "[^"]+", (run_\w+)\}/);
exit $bad;
