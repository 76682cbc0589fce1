#!/usr/bin/perl
# Runs one of LaTeXML's two steps on many files.
#
#   latexml.pl xml|html THEME WORKERS <JOBS
#
# Each line of the standard input is a job: source, destination and log,
# separated by tabs. To load LaTeXML, LaTeX's definitions and the style sheet
# takes longer than to convert most chapters, so all is loaded once, and each
# job is a child of the process that has it. What a job complains of stands in
# its log; a job that failed leaves no destination.
use strict;
use warnings;
use Encode;
use LaTeXML;
use LaTeXML::Common::Error;
use LaTeXML::Common::XML;
use LaTeXML::Core;
use LaTeXML::Core::Token;
use LaTeXML::Global;
use LaTeXML::Post;
use LaTeXML::Post::MathML::Presentation;
use LaTeXML::Post::XSLT;
use LaTeXML::Util::Pathname;
use version;

# ---------------------------------------------------------------- words instead of letters
# LaTeXML makes a box of every letter, and asks for every box which font it has and where it belongs. A line of prose
# has one font and one place. Formulas are left alone: there a letter is a symbol. So are the characters that look
# otherwise than they are typed, as quotes and dashes do.

my $PROSE = qr/^[A-Za-z0-9.,;:!?()\/+=*]$/;

sub is_prose {
  my ($character, $category) = @_;
  return ($category == CC_LETTER || $category == CC_OTHER) && $character =~ $PROSE; }

# What follows in the same line of prose, taken from where LaTeXML would read it next. A single space belongs to it if
# prose follows; at any other, TeX may have to skip some.
sub rest_of_line {
  my ($gullet) = @_;
  my ($waiting, $mouth, $rest) = ($$gullet{pushback}, $$gullet{mouth}, '');
  while (@$waiting && is_prose(@{ $$waiting[0] }[0, 1])) {
    $rest .= shift(@$waiting)->toString; }
  return $rest if @$waiting || $$mouth{skipping_spaces};
  my ($characters, $place) = ($$mouth{chars} || [], $$mouth{colno});
  my $prose = sub {
    my $character = $$characters[$_[0]];
    return $_[0] < $$mouth{nchars} && is_prose($character, $$STATE{catcode}{$character}[0] // CC_OTHER); };
  while (1) {
    if ($prose->($place)) {
      $rest .= $$characters[$place++]; }
    elsif ($place < $$mouth{nchars} && $$characters[$place] eq ' ' && $prose->($place + 1)) {
      $rest .= ' ';
      $place++; }
    else {
      last; } }
  $$mouth{colno} = $place;
  return $rest; }

# A list of boxes in which neighbours that are mere text in the same font are one.
sub joined {
  my @waiting = @_;
  my @out;
  while (@waiting) {
    my $box = shift(@waiting);
    next unless defined $box;
    if (ref $box eq 'LaTeXML::Core::List') {
      unshift(@waiting, $box->unlist);
      next; }
    my $before = $out[-1];
    if (is_text($box) && $before && is_text($before) && $$before{string} =~ /\S/  # space alone may be ignored
      && $$box{properties}{font} == $$before{properties}{font}) {
      $out[-1] = LaTeXML::Core::Box::->new($$before{string} . $$box{string}, $$before{properties}{font},
        $$before{properties}{locator}); }
    else {
      push(@out, $box); } }
  return @out; }

# A box that has a font and a place, and nothing that would make it more than its letters.
sub is_text {
  my ($box) = @_;
  return ref $box eq 'LaTeXML::Core::Box' && defined $$box{string} && keys %{ $$box{properties} } == 2; }

# This knows LaTeXML from inside, and so it is used with the version that it knows; any other is only slower. The XML is
# the same to the byte; ten chapters take 15 CPU seconds instead of 21.
sub by_the_line {
  no warnings qw(redefine once);
  my $digest = \&LaTeXML::Core::Stomach::invokeToken_simple;
  *LaTeXML::Core::Stomach::invokeToken_simple = sub {
    my ($self, $token, $meaning) = @_;
    return $digest->(@_) if !is_prose(@$meaning[0, 1]) || $STATE->lookupValue('IN_MATH');
    my $gullet = $self->getGullet;
    my $line   = $meaning->toString . rest_of_line($gullet);
    $STATE->clearPrefixes;
    return LaTeXML::Core::Box::->new($line, $STATE->lookupValue('font'), $gullet->getLocator,
      bless([$line, CC_OTHER], 'LaTeXML::Core::Token')); };
  my $absorb = \&LaTeXML::Core::Document::absorb;
  *LaTeXML::Core::Document::absorb = sub {
    my ($self, $object, %properties) = @_;
    if (ref $object eq 'LaTeXML::Core::List' && !$properties{isMath} && !$object->isMath) {
      $object = LaTeXML::Core::List::->new(joined($object)); }
    return $absorb->($self, $object, %properties); };
  my ($name, %names) = (\&LaTeXML::Common::Model::getNodeQName);
  *LaTeXML::Common::Model::getNodeQName = sub {
    my $node = $_[1];
    return &$name unless defined $node && $node->nodeType == XML_ELEMENT_NODE;
    return $names{ $node->nodeName } //= &$name; };
  return; }

by_the_line() if $LaTeXML::VERSION == version->declare('0.8.7');

# ---------------------------------------------------------------- first step: LaTeX to XML
sub loaded_core {
  my ($theme) = @_;
  my $core = LaTeXML::Core->new(searchpaths => [$theme], includecomments => 0, includepathpis => 0);
  $core->withState(sub {
      $core->initializeState('TeX.pool', 'LaTeX.pool', 'book.cls', 'malus.sty');
      $_[0]->getModel->loadSchema; });
  return $core; }

sub to_xml {
  my ($core, $source) = @_;
  return $core->withState(sub {
      my $document = $core->convertDocument($core->digestFile($source, mode => 'TeX', noinitialize => 1));
      return $core->getStatusCode < 3 && Encode::encode('UTF-8', $document->toString(1)); }); }

# ---------------------------------------------------------------- second step: XML to HTML
sub loaded_steps {
  my %always = (searchpaths => ['.']);
  return [LaTeXML::Post::MathML::Presentation->new(plane1 => 1, %always),
    LaTeXML::Post::XSLT->new(stylesheet => 'LaTeXML-html5.xsl', noresources => 1, %always,
      parameters => { LATEXML_VERSION => "'$LaTeXML::VERSION'" })]; }

sub to_html {
  my ($steps, $source, $destination) = @_;
  my $post = LaTeXML::Post->new();
  my $html;
  $post->withState(sub {
      my $document = LaTeXML::Post::Document->newFromFile($source, validate => 0, destination => $destination,
        siteDirectory => pathname_directory($destination));
      ($document) = $post->ProcessChain($document, @$steps);
      $html = $document->getDocument->toStringHTML if $post->getStatusCode < 3; });
  return $html; }

# ---------------------------------------------------------------- the jobs
sub job {
  my ($make, $loaded, $source, $destination, $log) = @_;
  unlink($destination);
  UseLog($log);
  my $made = eval { $make->($loaded, $source, $destination) };
  my $why  = $@;
  Note("Error:died:$source $why") if $why && $why ne $LaTeXML::Common::Error::DIE_MESSAGE;
  UseLog(undef);
  exit(1) unless $made;
  open(my $out, '>', $destination) or die "$destination: $!\n";
  print $out $made;
  close($out) or die "$destination: $!\n";
  exit(0); }

my ($step, $theme, $workers) = @ARGV;
SetVerbosity(-1);
my $make   = { xml => \&to_xml, html => \&to_html }->{$step};
my $loaded = { xml => sub { loaded_core($theme) }, html => \&loaded_steps }->{$step}->();
my $busy   = 0;
while (my $line = <STDIN>) {
  chomp($line);
  if ($busy == $workers) {
    wait();
    $busy--; }
  my $child = fork() // die "fork: $!\n";
  job($make, $loaded, split(/\t/, $line)) unless $child;
  $busy++; }
1 while wait() > 0;
