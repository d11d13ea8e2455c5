#include "coppice/studio/menu/menu_internal.h"

namespace coppice {

std::string_view built_in_menu() {
    return R"(# The menu of the studio. A file of your own extends it; docs/user/studio.md explains how.

[File]
New scene = page new
Open... = page open
Save = page save
Save as... = page save-as
---
Import... = page import
Export... = page export
Picture... = page picture
Animation... = page animation

[Edit]
Undo = page undo
Redo = page redo
Stop subject runs = page cancel
---
Duplicate = page duplicate
Rename... = page rename
Delete = page delete
---
Another seed for all that follows... = line set seed ${ask Seed, 7}

[View]
Frame = page frame
Front = page look-front
Back = page look-back
Right = page look-right
Left = page look-left
Above = page look-top
Below = page look-bottom
Perspective or parallel = page projection
---
Wireframe = page wireframe
Hide = page hide
Show all = page show-all
---
Keyboard shortcuts = page shortcuts
Change this menu... = page menu-file

[Crown]
Place a solid = tool place
Curve = tool curve
Profile = tool profile
Revolve, sweep, skin = tool loft
Combine = tool combine
---
Ball of 2 m = line sphere ${new crown} radius=2 center=0,0,4
Egg = line sphere ${new crown} radius=${ask Radius in m, 2} center=0,0,${ask Height of its middle in m, 4}
Column = line cylinder ${new crown} from=0,0,2 to=0,0,6 skeleton_radius=1 radius=0.4
Cone = line cone ${new crown} from=0,0,1 to=0,0,7 from_radius=2 radius=0.2
Box = line box ${new crown} low=-2,-2,2 high=2,2,6 radius=0.3
Umbrella = line disc ${new crown} center=0,0,5 skeleton_radius=3 radius=0.5
Ring = line circle ${new crown} center=0,0,5 skeleton_radius=2 radius=0.5
---
Move = tool move
Turn = tool turn
Size = tool size
Twist... = line twist ${object} ${ask Degrees for each metre of height, 20}
Taper... = line taper ${object} ${ask How wide its end is, 0.5}
Bend... = line bend ${object} ${ask Degrees at its end, 30}
Mirror left and right = line scale ${object} -1,1,1
---
Its surface as a mesh = line polygonize ${object} ${new surface}
A mesh as a solid = line solid ${object} ${new crown}

[Points]
Fill with points = line pointset generate ${object} count=2000 distance=0 spacing=0.75
Fill with points... = line pointset generate ${object} count=${ask Number of points, 2000} seed=${ask Seed, 0}
In clusters = line pointset generate ${object} clustered count=2000
Near its boundary = line pointset generate ${object} density=inside_boundary count=2000
Towards its middle = line pointset generate ${object} density=proportional count=2000
Near a mesh = line pointset near ${object} count=2000
---
Brush of points = tool points
Thin within a solid... = line pointset thin ${object} ${ask Solid, crown} ${ask Per cent to remove, 50}
Densify within a solid... = line pointset densify ${object} ${ask Solid, crown} count=${ask Number of points, 500}
How even they lie = line pointset quality ${object}

[Growth]
Place a root = tool root
Grow into points... = line grow ${new tree} ${object} influence_radius=${ask Influence radius in m, 1} kill_radius=${ask Kill radius in m, 0.3} step=${ask Length of segments in m, 0.1}
Grow on into points... = line grow ${new tree} ${ask Points, crown} from=${object} influence_radius=${ask Influence radius in m, 1} kill_radius=${ask Kill radius in m, 0.3} step=${ask Length of segments in m, 0.1}
---
Broad-leaved tree by rules = line sprout ${new tree} seasons=12
Conifer by rules = line sprout ${new tree} seasons=12 whorls=true buds=5 branching_angle=75 apical_control=0.7
Tree by rules... = line sprout ${new tree} seasons=${ask Seasons, 12} branching_angle=${ask Angle of branches in degrees, 45} seed=${ask Seed, 0}
---
Radii by the pipe model = line radii ${object}
Radii by the pipe model... = line radii ${object} tip_radius=${ask Radius of tips in m, 0.01} pipe_exponent=${ask Exponent, 2.5}
Smooth subject grew = line tidy ${object}

[Branches]
Select = tool select
Select in a box = tool box
---
Bend = tool bend
Reshape = tool reshape
Draw a branch = tool draw
Graft = tool graft
Cut = tool cut
Detach = tool detach
Prune = tool prune
Mirror = tool mirror
---
Radius = tool radius
Taper = tool taper-branch
Straighten = tool straighten
Smooth = tool smooth
---
Smooth all axes = line edit smooth ${object} all passes=2
Thicken... = line edit thicken ${object} all ${ask Factor, 1.2}
Cut off short branches... = line edit prune ${object} length=${ask Shorter than so many metres, 0.3}
Cut off subject is in the shade... = line edit prune ${object} shade_share=${ask Part of the tips, 0.1}
Trim to a solid... = line edit prune ${object} solid=${ask Solid, crown}
Even segments... = line edit resample ${object} all ${ask Length in m, 0.1}
Let trees grow from one another = line edit attach ${object}
Bend trees apart = line edit apart ${object}

[Compose]
Variation = line compose ${new variation} ${object}
Variation... = line compose ${new variation} ${object} seed=${ask Seed, 1} probability=${ask Chance of a branch to be replaced, 0.7}
Variation from a library... = line compose ${new variation} ${object} library=${ask Library, oaks.branches} seed=${ask Seed, 1}
Add its branches to a library... = line library add ${ask Library, oaks.branches} ${object}
---
Sketch over photographs = tool sketch

[Surface]
Quads along the branches = line mesh ${object}
Quads of a finer surface = line mesh ${object} levels=3
Coarse quads = line mesh ${object} levels=0
Quads by ramifications = line mesh ${object} method=ramifications
Quads on metaballs = line mesh ${object} method=bmesh
Triangles of the field = line mesh ${object} method=tetrahedra
A tube for every axis = line mesh ${object} method=cylinders
---
Finer meshes from now on = set mesh.levels 3
Meshes by ramifications from now on = set mesh.method ramifications
)";
}

}  // namespace coppice
