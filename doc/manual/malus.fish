# completion of malus for fish; made from the program's own description
{% for c in commands %}
complete -c malus -n __fish_use_subcommand -f -a {{ c.name }} -d {{ c.summary | quoted }}
{% for f in c.flags if not f.placed %}
complete -c malus -n '__fish_seen_subcommand_from {{ c.name }}' -l {{ f.name[2:] }}{% if f.value %} -r{% endif %}{% if f.choices %} -f -a '{{ f.choices | join(" ") }}'{% endif %} -d {{ f.text | quoted }}
{% endfor %}
{% endfor %}
