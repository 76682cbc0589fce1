#compdef malus
# completion of malus for zsh; made from the program's own description
_malus() {
  local -a commands
  commands=(
{% for c in commands %}
    {{ (c.name ~ ":" ~ c.summary) | quoted }}
{% endfor %}
  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{% for c in commands %}
    {{ c.name }})
      _arguments {% for f in c.flags if not f.placed %}\
        '{{ "*" if f.several }}{{ f.name }}[{{ f.text | zsh }}]{% if f.value %}:{{ f.value | lower | zsh }}:{% if f.choices %}({{ f.choices | join(" ") }}){% else %}_files{% endif %}{% endif %}' {% endfor %}\
        '*:file:_files'
      ;;
{% endfor %}
  esac
}
_malus "$@"
