//! The building as IFC4, millimetres: walls by axis, profile and layers, openings with what fills them.

use super::building::{Opening, Space, Storey, Wall, storeys};
use super::dxf::Point;

struct Writer {
    text: String,
    next: u64,
    rooted: u64,
    body: u64,
    axis: u64,
}

/// A number as STEP writes it.
fn real(v: f64) -> String {
    let rounded = (v * 1e6).round() / 1e6;
    let text = format!("{rounded}");
    if text.contains('.') { text } else { format!("{text}.") }
}

fn refs(ids: &[u64]) -> String {
    let list: Vec<String> = ids.iter().map(|id| format!("#{id}")).collect();
    format!("({})", list.join(","))
}

impl Writer {
    fn add(&mut self, text: &str) -> u64 {
        self.next += 1;
        self.text.push_str(&format!("#{}={text};\n", self.next));
        self.next
    }

    /// Head of a rooted instance: a made-up `GlobalId`, no history, a name.
    fn root(&mut self, name: &str) -> String {
        self.rooted += 1;
        format!("'0PavilionOfEnfilade{:03}',$,'{name}',$", self.rooted)
    }

    fn point(&mut self, (x, y): Point, z: f64) -> u64 {
        let [x, y, z] = [x, y, z].map(|v| real(v * 1e3));
        self.add(&format!("IFCCARTESIANPOINT(({x},{y},{z}))"))
    }

    fn point2(&mut self, (x, y): Point) -> u64 {
        let [x, y] = [x, y].map(|v| real(v * 1e3));
        self.add(&format!("IFCCARTESIANPOINT(({x},{y}))"))
    }

    fn placement(&mut self, parent: Option<u64>, at: Point, z: f64, direction: Point) -> u64 {
        let at = self.point(at, z);
        let axes = if direction == (1.0, 0.0) {
            self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},$,$)"))
        } else {
            let up = self.add("IFCDIRECTION((0.,0.,1.))");
            let (x, y) = (real(direction.0), real(direction.1));
            let along = self.add(&format!("IFCDIRECTION(({x},{y},0.))"));
            self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},#{up},#{along})"))
        };
        let parent = parent.map_or("$".into(), |p| format!("#{p}"));
        self.add(&format!("IFCLOCALPLACEMENT({parent},#{axes})"))
    }

    /// A box: its rectangle's middle, its size.
    fn block(&mut self, middle: Point, (x, y): Point, height: f64) -> u64 {
        let at = self.point2(middle);
        let axes = self.add(&format!("IFCAXIS2PLACEMENT2D(#{at},$)"));
        let [x, y, height] = [x, y, height].map(|v| real(v * 1e3));
        let profile = self.add(&format!("IFCRECTANGLEPROFILEDEF(.AREA.,$,#{axes},{x},{y})"));
        let up = self.add("IFCDIRECTION((0.,0.,1.))");
        self.add(&format!("IFCEXTRUDEDAREASOLID(#{profile},$,#{up},{height})"))
    }

    fn shape(&mut self, solid: u64, axis: Option<u64>) -> u64 {
        let body = self.body;
        let mut list =
            vec![self.add(&format!("IFCSHAPEREPRESENTATION(#{body},'Body','SweptSolid',(#{solid}))"))];
        if let Some(line) = axis {
            let context = self.axis;
            list.insert(
                0,
                self.add(&format!("IFCSHAPEREPRESENTATION(#{context},'Axis','Curve2D',(#{line}))")),
            );
        }
        self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,{})", refs(&list)))
    }

    fn marks(&mut self, element: u64, values: &[(&str, String)]) {
        let ids: Vec<u64> = values
            .iter()
            .map(|(key, value)| self.add(&format!("IFCPROPERTYSINGLEVALUE('{key}',$,{value},$)")))
            .collect();
        let root = self.root("Pset_Enfilade");
        let set = self.add(&format!("IFCPROPERTYSET({root},{})", refs(&ids)));
        let root = self.root("marks");
        self.add(&format!("IFCRELDEFINESBYPROPERTIES({root},(#{element}),#{set})"));
    }

    fn wall(&mut self, wall: &Wall, storey: u64, floor: f64, in_world: bool) -> (u64, Vec<u64>) {
        let place = self.placement(Some(storey), wall.from, 0.0, wall.direction());
        let solid = self.block((wall.length() / 2.0, 0.0), (wall.length(), wall.thickness), wall.height);
        let ends = [self.point2((0.0, 0.0)), self.point2((wall.length(), 0.0))];
        let axis = (!wall.is_column).then(|| self.add(&format!("IFCPOLYLINE({})", refs(&ends))));
        let shape = self.shape(solid, axis);
        let tag = 1000 + self.rooted;
        let root = self.root(wall.name);
        let class = if wall.is_column { "IFCCOLUMN" } else { "IFCWALL" };
        let element = self.add(&format!("{class}({root},$,#{place},#{shape},'{tag}',$)"));
        let mut fillers = Vec::new();
        for opening in &wall.openings {
            fillers.push(self.opening(wall, element, place, floor, *opening, in_world));
        }
        if let Some(moves) = wall.moves {
            let text = |t: &str| format!("IFCLABEL('{t}')");
            self.marks(element, &[("Move", text(moves)), ("Name", text(wall.name))]);
        }
        (element, fillers)
    }

    fn opening(
        &mut self,
        wall: &Wall,
        element: u64,
        place: u64,
        floor: f64,
        o: Opening,
        in_world: bool,
    ) -> u64 {
        let hole_place = if in_world {
            let d = wall.direction();
            let at = (wall.from.0 + d.0 * o.at, wall.from.1 + d.1 * o.at);
            self.placement(None, at, floor + o.sill, d)
        } else {
            self.placement(Some(place), (o.at, 0.0), o.sill, (1.0, 0.0))
        };
        let size = (o.width, wall.thickness + 0.2);
        let solid = self.block((o.width / 2.0, 0.0), size, o.height);
        let shape = self.shape(solid, None);
        let root = self.root("opening");
        let hole = self.add(&format!("IFCOPENINGELEMENT({root},$,#{hole_place},#{shape},$,.OPENING.)"));
        let root = self.root("void");
        self.add(&format!("IFCRELVOIDSELEMENT({root},#{element},#{hole})"));
        let leaf_place =
            if in_world { hole_place } else { self.placement(Some(hole_place), (0.0, 0.0), 0.0, (1.0, 0.0)) };
        let solid = self.block((o.width / 2.0, 0.0), (o.width, 0.05), o.height);
        let shape = self.shape(solid, None);
        let (class, name) = if o.is_door { ("IFCDOOR", "door") } else { ("IFCWINDOW", "window") };
        let tag = 1000 + self.rooted;
        let root = self.root(name);
        let [height, width] = [o.height, o.width].map(|v| real(v * 1e3));
        let filler =
            self.add(&format!("{class}({root},$,#{leaf_place},#{shape},'{tag}',{height},{width},$,$,$)"));
        let root = self.root("fill");
        self.add(&format!("IFCRELFILLSELEMENT({root},#{hole},#{filler})"));
        filler
    }

    fn space(&mut self, space: &Space, storey: u64) -> u64 {
        let place = self.placement(Some(storey), space.low, 0.0, (1.0, 0.0));
        let size = (space.high.0 - space.low.0, space.high.1 - space.low.1);
        let solid = self.block((size.0 / 2.0, size.1 / 2.0), size, 2.9);
        let shape = self.shape(solid, None);
        let root = self.root(space.name);
        let element = self
            .add(&format!("IFCSPACE({root},$,#{place},#{shape},'{}',.ELEMENT.,.INTERNAL.,$)", space.name));
        let flags = [("Query", space.is_query), ("Reference", space.is_reference)];
        let values: Vec<(&str, String)> =
            flags.iter().filter(|f| f.1).map(|f| (f.0, "IFCBOOLEAN(.T.)".to_string())).collect();
        if !values.is_empty() {
            self.marks(element, &values);
        }
        element
    }

    fn storey(&mut self, storey: &Storey, building: u64, in_world: bool) -> u64 {
        let place = self.placement(Some(building), (0.0, 0.0), storey.floor, (1.0, 0.0));
        let root = self.root(storey.name);
        let floor = real(storey.floor * 1e3);
        let own = self.add(&format!("IFCBUILDINGSTOREY({root},$,#{place},$,$,.ELEMENT.,{floor})"));
        let mut inside = Vec::new();
        for wall in &storey.walls {
            let (element, fillers) = self.wall(wall, place, storey.floor, in_world);
            inside.push(element);
            inside.extend(fillers);
        }
        let root = self.root("contents");
        self.add(&format!("IFCRELCONTAINEDINSPATIALSTRUCTURE({root},{},#{own})", refs(&inside)));
        let spaces: Vec<u64> = storey.spaces.iter().map(|s| self.space(s, place)).collect();
        let root = self.root("rooms");
        self.add(&format!("IFCRELAGGREGATES({root},#{own},{})", refs(&spaces)));
        own
    }
}

/// The building as a STEP file; its doors and windows placed on their walls or in the world.
pub fn building(in_world: bool) -> String {
    let mut w = Writer { text: String::new(), next: 0, rooted: 0, body: 0, axis: 0 };
    let metre = w.add("IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)");
    let radian = w.add("IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)");
    let units = w.add(&format!("IFCUNITASSIGNMENT({})", refs(&[metre, radian])));
    let origin = w.point((0.0, 0.0), 0.0);
    let axes = w.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
    let context = w.add(&format!("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#{axes},$)"));
    let sub = |name: &str| {
        format!("IFCGEOMETRICREPRESENTATIONSUBCONTEXT('{name}','Model',*,*,*,*,#{context},$,.MODEL_VIEW.,$)")
    };
    w.body = w.add(&sub("Body"));
    w.axis = w.add(&sub("Axis"));
    let root = w.root("Pavilion");
    let project = w.add(&format!("IFCPROJECT({root},$,$,$,(#{context}),#{units})"));
    let place = w.placement(None, (0.0, 0.0), 0.0, (1.0, 0.0));
    let root = w.root("Pavilion");
    let building = w.add(&format!("IFCBUILDING({root},$,#{place},$,$,.ELEMENT.,$,$,$)"));
    let root = w.root("project");
    w.add(&format!("IFCRELAGGREGATES({root},#{project},(#{building}))"));
    let floors: Vec<u64> = storeys().iter().map(|s| w.storey(s, place, in_world)).collect();
    let root = w.root("storeys");
    w.add(&format!("IFCRELAGGREGATES({root},#{building},{})", refs(&floors)));
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [CoordinationView]'),'2;1');\n\
         FILE_NAME('pavilion.ifc','2026-01-01T00:00:00',(''),(''),'','Enfilade samples','');\n\
         FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
        w.text
    )
}
