#!/usr/bin/perl
# Fails when a document that code, tests or text cites does not exist: Markdown links with their anchors, and citations
# such as "docs/physics.md section 4.4" or "docs/conventions.md sections 1 and 2". Also: files and symbols that the
# contributor's routes name (CONTRIBUTING.md, "file: `symbol`") exist.
use strict;
use warnings;
use File::Basename qw(dirname);
use Cwd qw(abs_path);
chdir(dirname(abs_path($0)) . "/../..") or die;

my $bad = 0;
sub complain { print "@_\n"; $bad = 1; }
sub slurp { my ($path) = @_; open(my $in, '<:encoding(UTF-8)', $path) or die "$path: $!"; local $/; return scalar <$in>; }

# Every file of the tree that people wrote; build folders and binary data are left out.
my @files = grep { -T $_ && !-l $_ } split /\n/, `git ls-files --cached --others --exclude-standard 2>/dev/null`;
@files = grep { -T $_ } split /\n/, `find . -type f -not -path './build/*' -not -path './.git/*' | sed 's,^./,,'` unless @files;
@files = grep { !m{^tests/data/|^cases/.*/fields/|\.csv$} } @files;
my @pages = grep { /\.md$/ } @files;

# Anchors and section numbers of a page.
my (%anchors, %sections);
sub read_headings {
    my ($page) = @_;
    return if $anchors{$page};
    my $text = slurp($page);
    $text =~ s/^```.*?^```//msg;
    my (%found, %numbers, %seen);
    while ($text =~ /^#+\s+(.*?)\s*$/mg) {
        my $title = $1;
        $numbers{$1} = 1 if $title =~ /^(\d+(?:\.\d+)*)[. ]/;
        $title =~ s/\[([^\]]*)\]\([^)]*\)/$1/g;
        my $slug = lc $title;
        $slug =~ s/[^\w\- ]//g;
        $slug =~ s/ /-/g;
        my $count = $seen{$slug}++;
        $found{$count ? "$slug-$count" : $slug} = 1;
    }
    $found{$1} = 1 while $text =~ /<a (?:name|id)="([^"]+)"/g;
    ($anchors{$page}, $sections{$page}) = (\%found, \%numbers);
}

sub plain_path {  # "docs/guide/../files/x.md" -> "docs/files/x.md"
    my ($path) = @_;
    1 while $path =~ s{(^|/)(?!\.\./)[^/]+/\.\./}{$1};
    $path =~ s{(^|/)\./}{$1}g;
    return $path;
}

for my $page (@pages) {
    my $text = slurp($page);
    $text =~ s/^```.*?^```//msg;
    my $folder = dirname($page) eq '.' ? '' : dirname($page) . '/';
    while ($text =~ /\]\(([^)\s]+)(?:\s+"[^"]*")?\)/g) {
        my $target = $1;
        next if $target =~ m{^[a-z]+:};
        my ($path, $anchor) = split /#/, $target, 2;
        my $file = $path eq '' ? $page : plain_path("$folder$path");
        if (!-e $file) { complain("$page: the link '$target' leads nowhere"); next; }
        next unless defined $anchor && $file =~ /\.md$/;
        read_headings($file);
        complain("$page: '$file' has no heading '#$anchor'") unless $anchors{$file}{$anchor};
    }
}

for my $file (@files) {
    next if $file eq "tests/house/check_documents.pl" || $file eq "docs/mkdocs.yml";  # mkdocs checks its own
    my $text = slurp($file);
    while ($text =~ m{(?<![\w/.])(docs/[\w./-]+\.(?:md|csv|svg|png|1))((?:,? (?://+ ?)?sections? [\d., and]+\d)?)}g) {
        my ($path, $cited) = ($1, $2);
        if (!-e $path) { complain("$file cites $path, which does not exist"); next; }
        next unless $cited && $path =~ /\.md$/;
        read_headings($path);
        for my $number ($cited =~ /(\d+(?:\.\d+)*)/g) {
            complain("$file cites section $number of $path, which it does not have") unless $sections{$path}{$number};
        }
    }
    # A document named without its folder must be somewhere in the tree.
    while ($text =~ m{(?<![\w/.*-])([a-z][\w-]*\.md)\b}gi) {
        my $name = $1;
        next if $name =~ /^(PROVENANCE|mocap_data_description)\.md$/;  # beside the measurements of others, not in this tree
        complain("$file names $name, which does not exist") unless grep { m{(^|/)\Q$name\E$} } @pages;
    }
    complain("$file speaks of notes that are not in the repository: '$1'") if $text =~ /((?:physics|design) notes)/i;
}

# The routes of CONTRIBUTING.md: `path/of/file`: `symbol`, ...
if (-e 'CONTRIBUTING.md') {
    my $text = slurp('CONTRIBUTING.md');
    while ($text =~ /`([\w.\/-]+\/[\w.-]+\.(?:h|cpp|sh|pl|txt|md|toml|json|cmake))`(?:: ((?:`[^`]+`(?:, )?)+))?/g) {
        my ($path, $symbols) = ($1, $2);
        if (!-e $path) { complain("CONTRIBUTING.md names $path, which does not exist"); next; }
        next unless defined $symbols;
        my $code = slurp($path);
        for my $symbol ($symbols =~ /`([^`]+)`/g) {
            next if $symbol =~ m{^[\w./-]+/[\w.-]+\.\w+$};  # the next file of the list
            complain("CONTRIBUTING.md: $path does not hold '$symbol'") if index($code, $symbol) < 0;
        }
    }
}
exit $bad;
