# completion of malus for bash; made from the program's own description
_malus() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} words=
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{% for c in commands %}{{ c.name }} {% endfor %}--help --version' -- "$word")
    return
  fi
  case "$command $before" in
{% for c in commands %}
{% for f in c.flags if f.choices %}
    '{{ c.name }} {{ f.name }}') words='{{ f.choices | join(" ") }}' ;;
{% endfor %}
{% endfor %}
  esac
  if [[ -z $words && $word == -* ]]; then
    case "$command" in
{% for c in commands %}
      {{ c.name }}) words='{% for f in c.flags if not f.placed %}{{ f.name }} {% endfor %}' ;;
{% endfor %}
    esac
  fi
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  else
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -F _malus malus
