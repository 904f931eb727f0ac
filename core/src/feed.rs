//! Feed plan over plan time.
