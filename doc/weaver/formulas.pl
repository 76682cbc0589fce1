# Parses formulas by LaTeXML's own rules, but each place of a formula only once.
#
# LaTeXML leaves formulas to Parse::RecDescent, whose rules try their
# alternatives in turn and forget what they found when one fails: what stands
# in brackets is parsed four times, and sixteen times in two of them. Here the
# same rules become functions that look at the next word before they begin,
# and that remember what they made at a place. A formula is a list of words such
# as UNKNOWN:x:1, its first symbol; what stands before the colon is their kind.
use strict;
use warnings;

package Formula;
use LaTeXML::MathGrammar;
use LaTeXML::MathParser qw(:constructors);
use List::Util          qw(sum);
our ($AUTOLOAD, @words, @kinds, %made);

# LaTeXML calls a rule as a method, with the formula in a string, and expects there what is left of it.
sub AUTOLOAD {
  my ($self, $formula) = @_;
  my ($name) = $AUTOLOAD =~ /(\w+)$/;
  return if $name eq 'DESTROY';
  local @words = split(' ', $$formula);
  local @kinds = (map({ /^(\w+)/ } @words), '');    # '' is the end
  local %made  = ();
  my $place = 0;
  my $tree  = Formula::Rules->can($name)->($place);
  $$formula = join(' ', @words[$place .. $#words]);
  return $tree; }

# What can be told from the rules: the kinds of words a rule can begin with, or nothing if it can succeed without a word;
# and whether it depends on its arguments, 'rule' if one is the name of a rule, 'trees' if they are what was parsed.
sub study_rules {
  my ($rules) = @_;
  my (%begins, %empty, %asks);
  my ($known, $before) = (0, -1);
  while ($known != $before) {
    foreach my $name (keys %$rules) {
      foreach my $production (@{ $$rules{$name}{prods} }) {
        my $begun = 0;
        foreach my $item (@{ $$production{items} }) {
          my ($kind) = (ref $item) =~ /(\w+)$/;
          my ($rule, $arguments, $pattern, $code) = map { $$item{$_} // '' } qw(subrule argcode pattern code);
          if ($$item{matchrule}) {
            ($asks{$name}, $begun) = ('rule', 1); }
          elsif ($code =~ /[\$\@]arg\b/ || $arguments =~ /[\$\@]arg\b/ || !$arguments && $asks{$rule}) {
            $asks{$name} ||= 'trees'; }
          $begun ||= $kind eq 'UncondReject';    # this alternative never succeeds
          next if $begun || $kind eq 'Action';
          my @first = $rule ? keys %{ $begins{$rule} } : $pattern eq '^\Z' ? '' : $pattern =~ /^(\w+):/;
          push(@first, keys %{ $begins{$1} }) if ($asks{$rule} // '') eq 'rule' && $arguments =~ /^\['(\w+)'\]$/;
          $begins{$name}{$_} = 1 for @first;
          $begun = !$rule || !$empty{$rule} && ($$item{min} // 1); }
        $empty{$name} = 1 if !$begun; } }
    ($before, $known) = ($known, keys(%empty) + keys(%asks) + sum(map { scalar(keys %$_) } values %begins)); }
  delete @begins{ keys %empty };
  return (\%begins, \%asks); }

# A tree of its own for each who asks, since the parser notes in a tree what it was used for.
sub copy_of {
  my ($tree) = @_;
  return ref $tree eq 'ARRAY' ? [map { copy_of($_) } @$tree] : ref $tree eq 'HASH' ? {%$tree} : $tree; }

# The text of what an item of an alternative makes of the words at a place; nothing if its alternative never succeeds.
sub made_by {
  my ($item, $place) = @_;
  my ($kind) = (ref $item) =~ /(\w+)$/;
  my $arguments = $$item{argcode} ? "\@{$$item{argcode}}" : '@arg';
  return $kind eq 'Action' || $kind eq 'Directive' ? "do { $$item{code} }"
    : $kind eq 'Token' && $$item{pattern} eq '^\Z' ? "\$kinds[$place] eq '' ? '' : undef"
    : $kind eq 'Token'      ? "word($place, qr/^$$item{pattern}/)"
    : $kind eq 'Repetition' ? "several($place, \\&$$item{subrule}, $$item{min}, $$item{max}, $arguments)"
    : $kind eq 'Subrule'    ? ($$item{matchrule} ? '&{$arg[0]}' : $$item{subrule}) . "($place, $arguments)"
    :                         ''; }

# The text of a function (place, arguments...) that returns the tree of a rule and moves the place behind it, or undef.
sub function_of {
  my ($name, $rule) = @_;
  my $text = "sub {\nmy (\$begin, \@arg) = \@_;\nmy (\$place, \$ahead, \$commit, \$tree, \@item);\n$$rule{vars}\n";
  foreach my $production (@{ $$rule{prods} }) {
    $text .= "{\n\$place = \$begin;\n\@item = ('$name');\n";
    foreach my $item (@{ $$production{items} }) {
      my $make = made_by($item, $$item{lookahead} ? '$ahead' : '$place');
      $text .= "\$ahead = \$place;\n" if $$item{lookahead};
      $text .= $make ? "defined(\$tree = $make) or last;\npush(\@item, \$tree);\n" : "last;\n"; }
    $text .= "\$_[0] = \$place;\nreturn \$item[-1];\n}\nif (\$commit) { \$_[0] = \$place; return undef; }\n"; }
  return $text . "\$_[0] = \$place;\nreturn undef;\n}"; }

sub word {
  my (undef, $pattern) = @_;
  return $kinds[$_[0]] ne '' && $words[$_[0]] =~ $pattern ? $words[$_[0]++] : undef; }

sub several {
  my ($place, $rule, $least, $most, @arg) = @_;
  my @trees;
  while (@trees < $most) {
    my $next = $place;
    defined(my $tree = $rule->($next, @arg)) or last;
    push(@trees, $tree);
    last if @trees >= $least && $next == $place;
    $place = $next; }
  return undef if @trees < $least;    ## no critic: a list would be wrong, here and below
  $_[0] = $place;
  return \@trees; }

# Makes the functions, all in a package of their own, where they find each other by the names of the rules.
sub make_rules {
  my ($rules) = @_;
  my ($begins, $asks) = study_rules($rules);
  my %settings = map { $_ => 1 } map { $$_{vars} =~ /local (\$\w+)/g } values %$rules;    # by a rule for those it calls
  my $settings = join(', ', sort keys %settings);
  my $text     = "package Formula::Rules;\nour ($settings);\nno strict;\nuse LaTeXML::MathParser qw(:constructors);\n"
    . "*word = \\&Formula::word;\n*several = \\&Formula::several;\n*kinds = \\\@Formula::kinds;\n"
    . "({settings => sub { join(' ', map { \$_ // '' } $settings) }"
    . join('', map { ",\n$_ => " . function_of($_, $$rules{$_}) } sort keys %$rules) . "})";
  my $made = eval $text or die $@;    ## no critic: this is how rules become functions
  foreach my $name (keys %$rules) {
    my ($make, $setting, $first, $asks) = (@$made{ $name, 'settings' }, $$begins{$name}, $$asks{$name} // '');
    no strict 'refs';
    *{"Formula::Rules::$name"} = sub {
      my $kind = $kinds[$_[0]];
      return undef if $first && !$$first{$kind} && !($asks eq 'rule' && $$begins{ $_[1] }{$kind});
      goto &$make if $asks eq 'trees';
      my $key = join(' ', $name, $asks ? $_[1] : '', $_[0], $setting->());
      if (my $before = $made{$key}) {
        $_[0] = $$before[1];
        return copy_of($$before[0]); }
      my $tree = &$make;
      $made{$key} = [copy_of($tree), $_[0]];
      return $tree; }; }
  return; }

# From now on LaTeXML's parser of formulas is this one.
sub take_over {
  make_rules(LaTeXML::MathGrammar->new()->{rules});
  no warnings 'redefine';
  *LaTeXML::MathGrammar::new = sub { return bless({}, 'Formula'); };
  return; }

1;
