//! Errors: what went wrong stands once, as message and as documentation.

/// Enums and structs of errors, each variant with its message. A field is explained by the message that shows it.
#[doc(hidden)]
#[macro_export]
macro_rules! errors {
    () => {};
    ($(#[$attribute:meta])* pub enum $Name:ident {
        $($(#[$of:meta])* $Variant:ident $(($($inner:ident: $Inner:ty),+))? $({ $($field:ident: $Type:ty),* })? => $message:literal,)*
    } $($more:tt)*) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "the message shows the fields")]
        pub enum $Name {
            $(
                #[doc = concat!("`", $message, "`")]
                ///
                $(#[$of])*
                $Variant $(($($Inner),+))? $({ $($field: $Type),* })?,
            )*
        }

        impl core::fmt::Display for $Name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self {
                    $(Self::$Variant $(($($inner),+))? $({ $($field),* })? => write!(f, $message),)*
                }
            }
        }

        impl core::error::Error for $Name {}

        $crate::errors! { $($more)* }
    };
    ($(#[$attribute:meta])* pub struct $Name:ident => $message:literal; $($more:tt)*) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $Name;

        impl core::fmt::Display for $Name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                write!(f, $message)
            }
        }

        impl core::error::Error for $Name {}

        $crate::errors! { $($more)* }
    };
    ($(#[$attribute:meta])* pub struct $Name:ident { $($field:ident: $Type:ty),* } => $message:literal; $($more:tt)*) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "the message shows the fields")]
        pub struct $Name {
            $(pub $field: $Type,)*
        }

        impl core::fmt::Display for $Name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                let Self { $($field),* } = self;
                write!(f, $message)
            }
        }

        impl core::error::Error for $Name {}

        $crate::errors! { $($more)* }
    };
}
