# One look for all pictures. A script begins with `load style` and then only plots.
#
# Set by whoever calls gnuplot (malus reproduce does):
#   term   'svg' or 'png'          out   the file to be written
#   style  this file               item  the ID, e.g. 'F3.9'
# May be set by a script before it loads this file: width, height [pixels of the SVG].
#
# By hand, in the directory of an item:
#   gnuplot -e "style='../../../validation/plots/style.gp'; term='svg'; out='fresnel.svg'" ../../../validation/plots/fresnel.gp
#
# Data are CSV with one line of column names, so a script plots columns by name:
#   plot 'fresnel.csv' using 'zenith_deg':'Rs' with lines title 'R_s'
#
# Linetypes 1 to 8 are the colours of Okabe and Ito, distinguishable for colour-blind readers as well; the yellow,
# weak on white, comes last. Each has its own dash and point. By convention:
#   linestyle 11   as printed in the thesis (points)      linestyle 12   a reference line, e.g. zero

if (!exists("term")) term = 'svg'
if (!exists("width")) width = 640
if (!exists("height")) height = 420

# a generic family: every machine has one, and a picture need not carry letters with it
if (term eq 'svg') set terminal svg size width,height enhanced font 'sans-serif,14' linewidth 1 rounded
if (term eq 'png') set terminal pngcairo size 2*width,2*height enhanced font 'sans-serif,14' fontscale 2 linewidth 2 pointscale 2 rounded background '#ffffff'
if (exists("out")) set output out

set encoding utf8
set datafile separator ','
set datafile columnheaders
set datafile missing 'nan'

ink = '#333333'
set border 3 linecolor rgb ink linewidth 1
set tics nomirror out textcolor rgb ink
set xlabel textcolor rgb ink
set ylabel textcolor rgb ink
set zlabel textcolor rgb ink
set title textcolor rgb ink
set key textcolor rgb ink noautotitle samplen 3 spacing 1.2
set grid linecolor rgb '#b8b8b8' linewidth 0.6 dashtype solid
set samples 500

set linetype 1 linecolor rgb '#0072b2' linewidth 2 dashtype solid       pointtype 7
set linetype 2 linecolor rgb '#d55e00' linewidth 2 dashtype (14,5)      pointtype 5
set linetype 3 linecolor rgb '#009e73' linewidth 2 dashtype (3,4)       pointtype 9
set linetype 4 linecolor rgb '#cc79a7' linewidth 2 dashtype (14,4,3,4)  pointtype 11
set linetype 5 linecolor rgb '#e69f00' linewidth 2 dashtype solid       pointtype 13
set linetype 6 linecolor rgb '#56b4e9' linewidth 2 dashtype (14,5)      pointtype 6
set linetype 7 linecolor rgb '#333333' linewidth 2 dashtype (3,4)       pointtype 4
set linetype 8 linecolor rgb '#c9bc2e' linewidth 2 dashtype (14,4,3,4)  pointtype 8
set linetype cycle 8

set style line 11 linecolor rgb ink pointtype 6 pointsize 0.9 linewidth 1.5
set style line 12 linecolor rgb '#808080' linewidth 1 dashtype (2,3)

# zero-centred map for signed quantities (blue, white, vermillion), and a sequential one
signed_map = 'set palette defined (-1 "#0072b2", 0 "#ffffff", 1 "#d55e00")'
level_map = 'set palette defined (0 "#0b1f3a", 0.5 "#0072b2", 0.8 "#e69f00", 1 "#fff7d6")'
# for images: intensity as in the thesis, and an angle that closes on itself
grey_map = 'set palette defined (0 "#000000", 1 "#ffffff")'
hue_map = 'set palette model HSV defined (0 0 0.7 0.9, 1 1 0.7 0.9); set palette model RGB'
