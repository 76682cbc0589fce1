# X.error: claimed against observed standard errors of the copper chunky bar (spread.csv).
width = 560; height = 480
load style
set logscale xy
set format x '10^{%L}'; set format y '10^{%L}'
set xlabel 'spread over seeds'
set ylabel 'claimed standard error'
set key top left Left reverse samplen 1
of(c) = column('component') == c ? column('claimed') : NaN
plot x with lines linestyle 12, for [c = 0:3] 'spread.csv' using 'observed':(of(c)) with points linetype c + 1 pointsize 0.6 title sprintf('S_%d', c)
