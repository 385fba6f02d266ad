//! A furnished building of five storeys around an atrium, in the spirit of Soda Hall (Funkhouser and Séquin, 1993).
//!
//! Modules of six by six metres, ten from west to east and six from north to south, with galleries north and south of
//! the core; x points east, z south, y up. A storey is four metres high.

use glam::DVec3;

use super::dice::Dice;
use super::draft::{Draft, Stock};
use super::film::{Film, Key, key};
use super::{indoors, structure};
use crate::files::CameraPath;

/// One letter per module: `o` office, `d` dense office, `m` meeting room, `l` laboratory, `b` library, `r` server
/// room, `t` lecture hall, `k` kitchen, `w` store room, `.` gallery, `S` stairs, `A` atrium.
const STOREYS: [[&str; 6]; 5] = [
    ["ookmbbbmoo", "..........", "oS.AAAA.So", "oS.AAAA.So", "..........", "wokttttmow"],
    ["oodmlllooo", "..........", "dS.AAAA.So", "dS.AAAA.So", "..........", "oowbbkomoo"],
    ["oooomooood", "..........", "oS.AAAA.Sd", "oS.AAAA.Sd", "..........", "llllwkoooo"],
    ["rrwoodddoo", "..........", "oS.AAAA.So", "oS.AAAA.So", "..........", "ooomokodoo"],
    ["omomkbbwoo", "..........", "oS.AAAA.So", "oS.AAAA.So", "..........", "oodddmmwoo"],
];

const MODULE: f64 = 6.0;
const STOREY: f64 = 4.0;
const DESKS_OF_A_DENSE_OFFICE: usize = 6;

pub(super) fn draft(seed: u64) -> Draft {
    let mut site = Site::new(seed);
    for (storey, plan) in STOREYS.iter().enumerate() {
        let plan = Plan { rows: plan, floor: STOREY * storey as f64 };
        plan.modules().for_each(|module| site.build(&plan, module));
    }
    site.furnish_atrium();
    site.draft
}

/// One storey.
struct Plan<'a> {
    rows: &'a [&'a str; 6],
    floor: f64,
}

/// A place on a storey's grid.
#[derive(Clone, Copy)]
struct Module {
    column: usize,
    row: usize,
    room: u8,
}

impl Plan<'_> {
    fn modules(&self) -> impl Iterator<Item = Module> + use<'_> {
        (0..6).flat_map(move |row| {
            let letters = self.rows[row].bytes().enumerate();
            letters.map(move |(column, room)| Module { column, row, room })
        })
    }

    /// What is east (1, 0) or south (0, 1) of a module, and so on; `None` beyond the façade.
    fn beside(&self, module: Module, (east, south): (isize, isize)) -> Option<u8> {
        let row = module.row.checked_add_signed(south)?;
        let column = module.column.checked_add_signed(east)?;
        self.rows.get(row)?.as_bytes().get(column).copied()
    }

    /// The middle of a module's floor.
    fn middle(&self, module: Module) -> DVec3 {
        DVec3::new(MODULE * (module.column as f64 + 0.5), self.floor, MODULE * (module.row as f64 + 0.5))
    }
}

fn is_room(module: u8) -> bool {
    module.is_ascii_lowercase()
}

/// What the building is made and furnished of.
struct Stocks {
    slab: Stock,
    wall: Stock,
    window_wall: Stock,
    door_wall: Stock,
    railing: Stock,
    stairs: Stock,
    column: Stock,
    lamp: Stock,
    mobile: Stock,
    planter: Stock,
    chair: Stock,
    desk: Stock,
    computer: Stock,
    desk_lamp: Stock,
    shelf: Stock,
    cabinet: Stock,
    sofa: Stock,
    table: Stock,
    crockery: Stock,
    glassware: Stock,
    bench: Stock,
    rack: Stock,
    seat: Stock,
    whiteboard: Stock,
    coffee: Stock,
    piano: Stock,
}

impl Stocks {
    fn new(draft: &mut Draft) -> Self {
        Self {
            slab: draft.stock(structure::slab(MODULE)),
            wall: draft.stock(structure::wall(MODULE, STOREY)),
            window_wall: draft.stock(structure::window_wall(MODULE, STOREY)),
            door_wall: draft.stock(structure::door_wall(MODULE, STOREY)),
            railing: draft.stock(structure::railing(MODULE)),
            stairs: draft.stock(structure::stairs()),
            column: draft.stock(structure::column()),
            lamp: draft.stock(structure::pendant_lamp()),
            mobile: draft.stock(structure::mobile()),
            planter: draft.stock(indoors::planter()),
            chair: draft.stock(indoors::office_chair()),
            desk: draft.stock(indoors::desk()),
            computer: draft.stock(indoors::computer()),
            desk_lamp: draft.stock(indoors::desk_lamp()),
            shelf: draft.stock(indoors::shelf_of_books()),
            cabinet: draft.stock(structure::filing_cabinet()),
            sofa: draft.stock(indoors::sofa()),
            table: draft.stock(indoors::round_table()),
            crockery: draft.stock(indoors::crockery()),
            glassware: draft.stock(indoors::glassware()),
            bench: draft.stock(structure::lab_bench()),
            rack: draft.stock(structure::server_rack()),
            seat: draft.stock(indoors::theatre_seat()),
            whiteboard: draft.stock(structure::whiteboard()),
            coffee: draft.stock(indoors::coffee_machine()),
            piano: draft.stock(indoors::grand_piano()),
        }
    }
}

/// The building site.
struct Site {
    draft: Draft,
    stocks: Stocks,
    dice: Dice,
}

impl Site {
    fn new(seed: u64) -> Self {
        let mut draft = Draft::new("building", include_str!("../../../scenes/tables/building.json"));
        let stocks = Stocks::new(&mut draft);
        Self { draft, stocks, dice: Dice::new(seed, 1) }
    }

    fn build(&mut self, plan: &Plan, module: Module) {
        let middle = plan.middle(module);
        match module.room {
            b'A' => return,
            b'S' if module.row == 2 => self.put(self.stocks.stairs, middle, [0.0, 0.0, MODULE / 2.0]),
            b'S' => return,
            _ => self.put(self.stocks.slab, middle, [0.0, -0.3, 0.0]),
        }
        self.enclose(plan, module);
        match module.room {
            b'.' => self.furnish_gallery(middle),
            room if is_room(room) => self.furnish(room, middle),
            _ => {}
        }
    }

    /// Windows to the outside, a door wall to a gallery, a wall between different rooms, a railing above the atrium.
    fn enclose(&mut self, plan: &Plan, module: Module) {
        for side in [(0, -1), (1, 0), (0, 1), (-1, 0)] {
            let beside = plan.beside(module, side);
            let first = side.0 + side.1 > 0;
            let stock = match (module.room, beside) {
                (_, None) => self.stocks.window_wall,
                (b'.', Some(b'A')) if plan.floor > 0.0 => self.stocks.railing,
                (room, Some(b'.')) if is_room(room) => self.stocks.door_wall,
                (room, Some(other)) if is_room(room) && room != other && (first || !is_room(other)) => {
                    self.stocks.wall
                }
                _ => continue,
            };
            let [east, south] = [side.0, side.1].map(|s| s as f64 * MODULE / 2.0);
            self.put(stock, plan.middle(module), [east, 0.0, south]);
        }
    }

    fn furnish_gallery(&mut self, middle: DVec3) {
        self.put(self.stocks.lamp, middle, [0.0, 3.0, 0.0]);
        if self.dice.chance(0.25) {
            self.put(self.stocks.planter, middle, [1.8, 0.0, 2.0]);
        }
        if self.dice.chance(0.15) {
            self.put(self.stocks.sofa, middle, [-1.5, 0.0, 2.3]);
        }
    }

    fn furnish(&mut self, room: u8, middle: DVec3) {
        self.put(self.stocks.lamp, middle, [0.0, 3.0, 0.0]);
        match room {
            b'o' => self.office(middle),
            b'd' => self.workplaces(middle, DESKS_OF_A_DENSE_OFFICE),
            b'm' => self.meeting_room(middle),
            b'l' => self.laboratory(middle),
            b'b' => self.grid(middle, [3, 4], &[self.stocks.shelf, self.stocks.shelf]),
            b'r' => self.grid(middle, [6, 3], &[self.stocks.rack]),
            b't' => self.grid(middle, [6, 5], &[self.stocks.seat]),
            b'k' => self.kitchen(middle),
            _ => self.grid(middle, [2, 1], &[self.stocks.cabinet]),
        }
    }

    fn office(&mut self, middle: DVec3) {
        let desks = 1 + self.dice.below(2);
        self.workplaces(middle, desks);
        if self.dice.chance(0.6) {
            self.put(self.stocks.shelf, middle, [-2.6, 0.0, 1.5]);
        }
        if self.dice.chance(0.4) {
            self.put(self.stocks.planter, middle, [2.2, 0.0, 2.2]);
        }
    }

    /// Desks with all that belongs to them, three to a row.
    fn workplaces(&mut self, middle: DVec3, desks: usize) {
        for desk in 0..desks {
            let [x, z] = [(desk % 3) as f64 * 1.9 - 1.9, (desk / 3) as f64 * 2.6 - 1.3];
            let turn = self.dice.between(-0.3, 0.3);
            self.put(self.stocks.desk, middle, [x, 0.0, z]);
            self.put(self.stocks.chair, middle, [x + turn, 0.0, z + 0.8]);
            self.put(self.stocks.computer, middle, [x + turn, 0.75, z]);
            if self.dice.chance(0.5) {
                self.put(self.stocks.desk_lamp, middle, [x - 0.6, 0.75, z - 0.2]);
            }
            if self.dice.chance(0.4) {
                self.put(self.stocks.cabinet, middle, [x + 0.9, 0.0, z - 0.9]);
            }
        }
    }

    fn meeting_room(&mut self, middle: DVec3) {
        self.put(self.stocks.whiteboard, middle, [0.0, 0.8, -2.8]);
        for table in [-1.2, 1.2] {
            self.put(self.stocks.table, middle, [table, 0.0, 0.0]);
            for (x, z) in [(0.0, -1.0), (0.0, 1.0), (-1.0, 0.0), (1.0, 0.0)] {
                self.put(self.stocks.chair, middle, [table + x, 0.0, z]);
            }
        }
    }

    fn laboratory(&mut self, middle: DVec3) {
        for z in [-1.8, 0.2, 2.2] {
            self.put(self.stocks.bench, middle, [0.0, 0.0, z]);
            for x in [-0.8, 0.8] {
                self.put(self.stocks.glassware, middle, [x, 0.9, z]);
            }
            let along = self.dice.between(-1.5, 1.5);
            self.put(self.stocks.chair, middle, [along, 0.0, z + 0.8]);
        }
        self.put(self.stocks.computer, middle, [1.5, 0.9, 2.2]);
    }

    fn kitchen(&mut self, middle: DVec3) {
        self.put(self.stocks.coffee, middle, [-2.4, 0.9, -2.4]);
        self.put(self.stocks.bench, middle, [-1.2, 0.0, -2.4]);
        self.put(self.stocks.sofa, middle, [1.6, 0.0, 2.3]);
        for (x, z) in [(-1.4, 0.4), (1.4, -0.4)] {
            self.put(self.stocks.table, middle, [x, 0.0, z]);
            self.put(self.stocks.crockery, middle, [x, 0.75, z]);
            self.put(self.stocks.chair, middle, [x - 1.0, 0.0, z]);
            self.put(self.stocks.chair, middle, [x + 1.0, 0.0, z]);
        }
    }

    /// Rows of the same, filling the module.
    fn grid(&mut self, middle: DVec3, [columns, rows]: [usize; 2], stocks: &[Stock]) {
        let step = |i: usize, n: usize| ((i as f64 + 0.5) / n as f64 - 0.5) * 5.0;
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            for (back, &stock) in stocks.iter().enumerate() {
                self.put(stock, middle, [step(column, columns), 0.0, step(row, rows) + 0.4 * back as f64]);
            }
        }
    }

    /// The atrium spans columns 3 to 6 and rows 2 and 3.
    fn furnish_atrium(&mut self) {
        let middle = DVec3::new(30.0, 0.0, 18.0);
        for (x, z) in [(-9.0, -3.0), (-3.0, -3.0), (3.0, -3.0), (9.0, -3.0)] {
            self.put(self.stocks.slab, middle, [x, -0.3, z]);
            self.put(self.stocks.slab, middle, [x, -0.3, -z]);
            self.put(self.stocks.planter, middle, [x + 1.5, 0.0, 4.5]);
            self.put(self.stocks.sofa, middle, [x, 0.0, 2.5]);
        }
        for (x, storey) in [-12.0, 12.0].into_iter().flat_map(|x| (0..5).map(move |s| (x, s))) {
            self.put(self.stocks.column, middle, [x, STOREY * f64::from(storey), -6.0]);
            self.put(self.stocks.column, middle, [x, STOREY * f64::from(storey), 6.0]);
        }
        self.put(self.stocks.mobile, middle, [-4.0, 8.0, 0.0]);
        self.put(self.stocks.mobile, middle, [5.0, 6.0, -1.0]);
        self.put(self.stocks.piano, middle, [0.0, 0.0, -3.0]);
    }

    fn put(&mut self, stock: Stock, middle: DVec3, [east, up, south]: [f64; 3]) {
        self.draft.put(stock, middle + DVec3::new(east, up, south));
    }
}

/// Eye level on the ground floor.
const EYE: f64 = 1.7;
const FIRST: f64 = EYE + STOREY;
const SECOND: f64 = EYE + 2.0 * STOREY;
const TOP: f64 = EYE + 4.0 * STOREY;

/// A visitor in a hurry.
const VISIT: &[Key] = &[
    // In by the west end of the north gallery, past the offices.
    key(0.0, [1.0, EYE, 9.0], 320.0, -4.0),
    key(2.0, [1.0, EYE, 9.0], 320.0, -4.0),
    key(4.0, [3.0, EYE, 9.0], 390.0, -2.0),
    key(7.0, [9.0, EYE, 9.0], 360.0, -2.0),
    // A look through the doorway of the library, and on into the atrium.
    key(8.5, [13.0, EYE, 9.0], 440.0, 0.0),
    key(12.0, [25.0, EYE, 8.0], 400.0, -3.0),
    key(13.5, [27.0, EYE, 9.5], 510.0, 6.0),
    key(16.5, [28.0, EYE, 15.0], 480.0, 35.0),
    key(19.0, [28.0, EYE, 16.0], 440.0, 45.0),
    // The piano, close up, standing still.
    key(22.0, [29.0, EYE, 16.6], 400.0, -18.0),
    key(25.0, [29.0, EYE, 16.6], 400.0, -18.0),
    // South gallery, turn on the heel into the lecture hall.
    key(29.0, [20.0, EYE, 26.0], 250.0, 0.0),
    key(30.0, [20.0, EYE, 27.5], 180.0, -6.0),
    key(33.0, [20.0, EYE, 31.0], 110.0, -8.0),
    key(36.0, [20.0, EYE, 27.0], 270.0, 0.0),
    // Up the west stairs, and again.
    key(39.0, [9.0, EYE, 25.0], 360.0, 12.0),
    key(43.0, [9.0, FIRST, 11.0], 360.0, 12.0),
    key(44.5, [9.5, FIRST, 9.0], 440.0, 0.0),
    // A doorway reveal: the laboratories of the first storey.
    key(48.0, [26.0, FIRST, 8.5], 420.0, 0.0),
    key(48.8, [26.5, FIRST, 7.5], 355.0, -6.0),
    key(51.0, [27.0, FIRST, 4.0], 400.0, -12.0),
    key(54.0, [27.0, FIRST, 4.0], 400.0, -12.0),
    key(55.0, [27.0, FIRST, 8.5], 530.0, -10.0),
    key(59.0, [51.0, FIRST, 9.0], 540.0, 8.0),
    key(63.0, [51.0, SECOND, 25.0], 530.0, 0.0),
];

/// The lift, and the view from the top gallery.
const GALLERY: &[Key] = &[
    key(63.0, [42.0, TOP, 9.0], 90.0, 0.0),
    key(65.0, [45.0, TOP, 9.0], 95.0, 0.0),
    key(67.5, [43.0, TOP, 10.5], 220.0, -15.0),
    key(70.0, [39.0, TOP, 11.6], 235.0, -40.0),
    key(73.0, [30.0, TOP, 11.6], 200.0, -45.0),
    key(76.0, [30.0, TOP, 11.6], 200.0, -45.0),
    key(79.0, [24.0, TOP, 9.5], 330.0, 10.0),
    key(80.0, [22.0, TOP, 9.0], 345.0, 25.0),
];

pub(super) fn path(seed: u64) -> CameraPath {
    Film { name: "building", hz: 20, sway_deg: 1.5, shots: &[VISIT, GALLERY] }.shoot(seed)
}
