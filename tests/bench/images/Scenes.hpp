// What images of the sun bring in scenes of several kinds.
#pragma once
void printScenes();
